// The build of this program, as cmake/PodmBuildInfo.cmake recorded it.
#pragma once

namespace podm::cli {

/// Returns lines "key: value" for compiler, flags, commit, dirty and libraries, without a newline at the end.
/// dirty is true if sources differ from their commit. commit and dirty are "unknown" outside a checkout.
const char* build_info();

}  // namespace podm::cli
