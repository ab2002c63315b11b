#include "apps/tetravox/options_preintegration.h"

#include "apps/tetravox/option_adding.h"

#include "tetravox/render.h"

#include <string>
#include <vector>

namespace tetravox::tool {
namespace {

/// "SCALARS" or "SCALARS,LENGTHS".
void parse_size(const std::string& option, const std::string& text, PreintegrationOptions& tables) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() > 2) throw UsageError(option + ": '" + text + "' is not SCALARS or SCALARS,LENGTHS");
  tables.scalars = static_cast<int>(parse_integer(option, parts[0], 2, kLargestDensityMapSize));
  if (parts.size() == 2) tables.lengths = static_cast<int>(parse_integer(option, parts[1], 2, kLargestTableSize));
}

}  // namespace

void add_integrator(CLI::App& app, MethodOptions& method) {
  PreintegrationOptions& tables = method.preintegration;
  add(app, "--integrator", "NAME", "What turns a segment into colour (tetravox list methods)",
      [&method](const std::string& option, const std::string& text) {
        RenderSettings parsed;
        const auto parse = [&](const std::string& name) {
          parse_integrator(name, parsed);
          return 0;
        };
        named(parse)(option, text);
        method.integrator = parsed.integrator;
        if (text.find('=') != std::string::npos) method.preintegration.degree = parsed.preintegration.degree;
      });
  add(app, "--preintegration-size", "N[,M]",
      "Entries along the scalars of table3d and polynomial, and along the length of table3d (default: 128,64)",
      [&tables](const std::string& option, const std::string& text) { parse_size(option, text, tables); });
  add(app, "--preintegration-lengths", "NAME", "How table3d spaces lengths: logarithmic (default), uniform",
      store(tables.length_spacing, named(length_spacing_from_name)));
  add(app, "--preintegration-opacity", "NAME", "Opacity of polynomial: exponential (default), linear",
      store(tables.opacity, named(opacity_model_from_name)));
  add(app, "--preintegration-planes", "N", "Planes of cylindrical (default: 65)",
      store(tables.planes, integer(2, kLargestPlaneCount)));
  add(app, "--preintegration-tile", "N", "Texels along the sides of a plane of cylindrical (default: 64)",
      store(tables.tile, integer(2, kLargestTableSize)));
  add(app, "--preintegration-steps", "N", "Steps that each entry of a table is integrated in (default: 64)",
      store(tables.steps, integer(1, kMostIntegrationSteps)));
  add(app, "--preintegration-bits", "8|12|16|32", "Bits that a table stores each number in (default: 32, float)",
      [&tables](const std::string& option, const std::string& text) {
        constexpr int kBits[] = {8, 12, 16, 32};
        tables.bits = kBits[parse_choice(option, text, {"8", "12", "16", "32"})];
      });
  add(app, "--preintegration-device", "cpu|gpu", "What makes tables: cpu (default), or what draws by OpenGL",
      store(tables.device, named(table_device_from_name)));
  add(app, "--preintegration-incremental", "on|off", "Make entries of a table from each other (default: on)",
      store(tables.use_incremental, parse_switch));
}

}  // namespace tetravox::tool
