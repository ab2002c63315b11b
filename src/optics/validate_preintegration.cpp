#include "tetravox/error.h"
#include "tetravox/preintegration.h"

#include <string>

namespace tetravox {

void validate_preintegration(const PreintegrationSettings& settings) {
  const auto require = [](const std::string& what, int number, int least, int largest) {
    if (number < least || number > largest)
      throw Error(ErrorCode::kInvalidArgument, what + ": " + std::to_string(number) + " is not between " +
                                                   std::to_string(least) + " and " + std::to_string(largest));
  };
  require("scalars of pre-integration tables", settings.scalars, 2, kLargestDensityMapSize);
  require("lengths of pre-integration tables", settings.lengths, 2, kLargestTableSize);
  require("degree of the chromaticity", settings.degree, 0, kLargestDegree);
  require("planes of the cylindrical atlas", settings.planes, 2, kLargestPlaneCount);
  require("tile of the cylindrical atlas", settings.tile, 2, kLargestTableSize);
  require("steps of pre-integration", settings.steps, 1, kMostIntegrationSteps);
  if (settings.bits != 8 && settings.bits != 12 && settings.bits != 16 && settings.bits != 32)
    throw Error(ErrorCode::kInvalidArgument,
                "bits of pre-integration tables: " + std::to_string(settings.bits) + " is not 8, 12, 16 or 32");
}

}  // namespace tetravox
