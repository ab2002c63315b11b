#pragma once

/// Functions of several variables, and colour from another array than opacity, as a renderer keeps them.

#include "src/cpu/kernels/kernels.h"
#include "src/optics/antiderivative_table.h"
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
  double gradient_scale = 1.0;  ///< value per world length / stored scalar per local length
  std::vector<optics::ScalarMap> others;
};

struct Domain {
  int count = 0;  ///< of axes; 0: one variable is all there is
  std::array<DomainAxis, kMostVariables> axes;
  std::array<std::optional<std::size_t>, kMostVariables> others;  ///< of each axis: which further scalars
  std::vector<float> entries;                                     ///< see DomainFunction; empty: colour alone
  optics::ControlPointTable colors;

  bool is_set() const { return count > 0; }
  bool is_table() const { return !entries.empty(); }
  bool wants_gradients() const;
  std::uint64_t bytes() const { return entries.size() * sizeof(float) + colors.bytes(); }
};

/// `others`: see `Renderer::set_multidimensional_function`.
/// @throws Error (kInvalidArgument) where there are fewer of them.
Domain make_table_domain(const OpticalTable& table, const std::vector<std::size_t>& others,
                         const DomainScalars& scalars);

/// `function`: gives the extinction.
/// @throws Error (kInvalidArgument) where there are fewer others.
Domain make_color_domain(std::size_t other, const OpticalFunction& colors, const OpticalFunction& function,
                         const DomainScalars& scalars);

/// For the kernels, at a tolerance. Points into `domain`.
DomainFunction make_domain_function(const Domain& domain, double tolerance, double diagonal);

const Kernels::OfDomain& choose_domain_kernels(const Kernels& kernels, const Domain& domain);

/// @throws Error (kUnsupported) for settings that do not go with a domain.
void require_domain_settings(const RenderSettings& settings);

/// How many entries of a table absorb, over any box of them at once (summed-area table; Crow 1984).
class TableOccupancy {
 public:
  /// Those count whose extinction is above `least`.
  TableOccupancy(const Domain& domain, float least);

  /// Whether nothing absorbs where axis i takes stored scalars in `ranges[i]`.
  bool is_empty(const std::array<ValueRange, kMostVariables>& ranges) const;

 private:
  std::uint32_t count_below(const std::array<std::int32_t, kMostVariables>& end) const;

  const Domain& domain_;
  std::array<std::int32_t, kMostVariables> sizes_{1, 1, 1};
  std::vector<std::uint32_t> sums_;  ///< [..] like the entries, of all before them along every axis and themselves
};

}  // namespace tetravox::cpu
