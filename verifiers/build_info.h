// The build of this program, recorded by cmake/PodmBuildInfo.cmake.
#pragma once

namespace podm::verify {

/// Returns lines "key: value" with compiler, flags, commit, dirty and libraries; the last line has no line
/// end. `dirty` is true if the sources differ from their commit. Commit and dirty are "unknown" outside a
/// checkout.
const char* build_info();

}  // namespace podm::verify
