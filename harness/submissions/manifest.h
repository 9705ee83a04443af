// The first file of a submission: its division, its submitter, and the hashes of the other files.
#pragma once

#include <array>
#include <string>

#include "rows/fields.h"

namespace podm::bench {

inline constexpr const char *kManifestSchema = "podm-submission/1", *kManifestName = "manifest.json";

/// Results of one division are comparable. Closed: inputs and bounds of the suite's own experiments, measured
/// by podm-bench's clock. Open: anything that the submitter declares.
enum class Division { kClosed, kOpen };
constexpr std::array<const char*, 2> names_of(Division) { return {"closed", "open"}; }

struct Manifest {
  std::string schema = kManifestSchema;
  Division division = Division::kClosed;
  std::string submitter;      ///< a name, and an institution if the submitter likes
  std::string declaration;    ///< free text: how the results were made, and what differs from the suite
  std::string date;           ///< UTC, in the format of ISO 8601
  std::string podm_bench;     ///< version of the program that packed the files
  ByName<std::string> files;  ///< SHA-256 of each other file
  static constexpr auto fields() {
    return PODM_FIELDS(Manifest, schema, division, submitter, declaration, date, podm_bench, files);
  }
};

}  // namespace podm::bench
