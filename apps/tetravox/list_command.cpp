#include "apps/tetravox/backend.h"
#include "apps/tetravox/commands.h"
#include "apps/tetravox/method_choice.h"
#include "apps/tetravox/text.h"

#include "tetravox/environment.h"
#include "tetravox/grid.h"
#include "tetravox/io.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"
#include "tetravox/slicing.h"
#include "tetravox/transfer_function.h"
#include "tetravox/visibility.h"

#include <cstddef>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string with_title(const std::string& title, const Rows& rows) { return title + "\n" + format_table(rows); }

Rows instruction_set_rows() {
  Rows rows;
  for (const std::string& name : instruction_sets()) rows.emplace_back(name, rows.empty() ? "used by default" : "");
  return rows;
}

Rows builtin_rows(Rows rows) {
  for (auto& row : rows) row.first = "builtin:" + row.first;
  return rows;
}

Rows function_rows() {
  Rows rows = preset_names();
  rows.emplace_back("auto:boundaries=T",
                    "from the data: opaque between materials, T times as thick as they are blurred");
  return rows;
}

}  // namespace

void run_list(const ListOptions& options) {
  switch (options.topic) {
    case ListOptions::Topic::kPresets:
      std::cout << with_title("Presets for --transfer-function, as COLOURS or COLOURS:OPACITY:", function_rows());
      break;
    case ListOptions::Topic::kReaders:
      std::cout << with_title("Files that can be read:", reader_names())
                << with_title("Pictures that can be written:", image_writer_names());
      break;
    case ListOptions::Topic::kBuiltins:
      std::cout << with_title(
          "Embedded datasets; each takes a size, as in builtin:duct?cells=1000000 or builtin:hydrogen?size=64:",
          builtin_rows(builtin_names()));
      break;
    case ListOptions::Topic::kEnvironments:
      std::cout << with_title("Embedded surroundings for --environment:", builtin_rows(builtin_environment_names()));
      break;
    case ListOptions::Topic::kDevices:
      std::cout << with_title("Devices for --backend gl (--gl-device):", device_names());
      break;
    case ListOptions::Topic::kSorts:
      std::cout << with_title("Orders of cells (tetravox order --sort):", sort_method_names());
      break;
    case ListOptions::Topic::kMethods:
      std::cout << with_title("What draws by what (--backend, --source, --integrator):", method_rows())
                << with_title("Sources (--source):", source_names())
                << with_title("Kinds of slices (--source slices=KIND):", slicing_kind_names())
                << with_title("Slabs between slices (--slabs):", slab_shape_names())
                << with_title("Orders of projected cells (--sort):", cell_sort_names())
                << with_title("Where projected cells become triangles (--decomposition):", decomposition_names())
                << with_title("What of the mesh is sent for a frame (--mesh-transfer):", mesh_transfer_names())
                << with_title("Classifications (--classification):", classification_names())
                << with_title("Integrators (--integrator):", integrator_names())
                << with_title("Orders of entries, by OpenGL (--entry-order):", entry_order_names())
                << with_title("Filters of grids (--filter):", filter_names())
                << with_title("Gradients (--gradient):", gradient_method_names())
                << with_title("Shadows (--shadows):", shadow_kind_names())
                << with_title("Variables of functions (--variables):", variable_kind_names())
                << with_title("Widgets (--widget):", widget_shape_names())
                << with_title("Opacity weights (--opacity-weight):", opacity_weight_names())
                << with_title("Instruction sets (--instruction-set):", instruction_set_rows());
      break;
  }
}

}  // namespace tetravox::tool
