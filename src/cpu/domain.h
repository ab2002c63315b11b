#pragma once

/// Functions of several variables, and colour from another array than opacity, as a renderer keeps them.

#include "src/cpu/kernels/kernels.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/steepness_table.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetravox::cpu {

/// How the scalars of the data are stored.
struct DomainScalars {
  optics::ScalarMap scalar;
  ValueRange range;             ///< of the values
  double gradient_scale = 1.0;  ///< value per world length / stored scalar per local length
  std::vector<optics::ScalarMap> others;
};

struct Domain {
  int count = 0;  ///< of axes; 0: one variable is all there is
  std::array<DomainAxis, kMostVariables> axes;
  std::array<std::optional<std::size_t>, kMostVariables> others;  ///< of each axis: which further scalars
  std::vector<float> entries;                                     ///< see DomainFunction; empty: colour alone
  optics::ControlPointTable colors;
  optics::SteepnessTable extinctions;  ///< of the transfer function, with `colors`

  bool is_set() const { return count > 0; }
  bool is_table() const { return !entries.empty(); }
  bool wants_gradients() const;
  std::uint64_t bytes() const {
    return (entries.size() + extinctions.steepness.size() + extinctions.extinction.size()) * sizeof(float) +
           colors.bytes();
  }
};

/// `others`: see `Renderer::set_multidimensional_function`.
/// @throws Error (kInvalidArgument) where there are fewer of them.
Domain make_table_domain(const OpticalTable& table, const std::vector<std::size_t>& others,
                         const DomainScalars& scalars);

/// `function`: gives the extinction.
/// @throws Error (kInvalidArgument) where there are fewer others.
Domain make_color_domain(std::size_t other, const OpticalFunction& colors, const OpticalFunction& function,
                         const DomainScalars& scalars);

const Kernels::OfDomain& choose_domain_kernels(const Kernels& kernels, const Domain& domain);

/// @throws Error (kUnsupported) for settings that do not go with a domain.
void require_domain_settings(const Domain& domain, const RenderSettings& settings);

/// How many entries of a table absorb, over any box of them at once (summed-area table; Crow 1984).
struct TableOccupancy {
  double tolerance = 0.0;          ///< that it was made for
  std::vector<std::int32_t> sums;  ///< see `DomainFunction::occupied`
};

/// Those count whose extinction is above what counts as none. Made anew for another tolerance.
void build_occupancy(const Domain& domain, double tolerance, double diagonal, TableOccupancy& occupancy);

/// Whether nothing absorbs where axis i takes stored scalars in `ranges[i]`.
bool is_transparent(const Domain& domain, const TableOccupancy& occupancy,
                    const std::array<ValueRange, kMostVariables>& ranges);

/// For the kernels, at a tolerance. Points into `domain` and `occupancy`, which is that of a table.
DomainFunction make_domain_function(const Domain& domain, const TableOccupancy& occupancy, double tolerance,
                                    double diagonal);

}  // namespace tetravox::cpu
