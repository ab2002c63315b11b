#include "tetravox/error.h"
#include "tetravox/grid.h"

namespace tetravox {

PreparedGrid prepare_grid(const GridData&, const Progress&) { throw Error(ErrorCode::kInternal, "soon"); }

MemoryEstimate estimate_prepare_memory(const GridData&) { return {}; }

}  // namespace tetravox
