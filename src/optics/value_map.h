#pragma once

/// From [0, 1] to values.

#include "tetravox/transfer_function.h"

namespace tetravox::optics {

/// @throws Error (kInvalidArgument) for a range that is not finite or descends, or is not positive for a logarithm.
void require_range(const ValueRange& range, bool logarithmic);

/// Linear or logarithmic, ascending, exact at both ends. A range without width is given a little of it, so that its
/// one value lies in the middle.
class ValueMap {
 public:
  /// @throws Error as `require_range`.
  ValueMap(ValueRange range, bool logarithmic);

  double value(double t) const;

 private:
  ValueRange range_;
  bool logarithmic_;
};

}  // namespace tetravox::optics
