// How this program was built, told by cmake/PodmBuildInfo.cmake.
#pragma once

namespace podm::cli {

/// Lines "key: value" of compiler, flags, commit, dirty and libraries, the last not ended. Commit and dirty,
/// which is true where sources differ from their commit, are "unknown" outside a checkout.
const char* build_info();

}  // namespace podm::cli
