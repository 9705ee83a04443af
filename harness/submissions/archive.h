// Files packed into one archive, a compressed tar. Both ends work in memory: reading an archive of a stranger
// writes nothing, whatever names the archive has.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "errors.h"

namespace podm::bench {

/// The contents of files by their names in the archive, such as "rows/quality.jsonl".
using PackedFiles = std::map<std::string, std::string>;

/// An archive beyond a limit is refused. A small archive may unpack to a huge one.
struct ArchiveLimits {
  std::size_t bytes = std::size_t{1} << 29;           ///< of all files together, unpacked
  std::size_t bytes_per_file = std::size_t{1} << 27;  ///< unpacked
  std::size_t files = 100'000;                        ///< including folders
};

/// Returns the archive (.tar.gz). Equal files give equal bytes.
std::string pack(const PackedFiles& files);

/// Returns the files of the archive at a path. Throws InputError that names the archive and the fault if the
/// file is not such an archive, is cut off, exceeds a limit, or has an entry other than a plain file or a
/// folder, a name that is absolute or goes up, or a name twice.
PackedFiles unpack(const std::string& path, const ArchiveLimits& limits = {});

}  // namespace podm::bench
