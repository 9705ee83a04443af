// A submission: rows with their logs, read from a packed archive or from a folder of results.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "submissions/archive.h"
#include "submissions/fault.h"
#include "submissions/manifest.h"

namespace podm::bench {

/// A row, and the files that the mesher and the verifier wrote about its mesh.
struct SubmittedRow {
  Row row;
  JsonPointer as_written;                   ///< the line
  std::map<std::string, std::string> logs;  ///< by the names of kLogNames
};

/// True if another run makes the row's mesh to the bit: one thread or virtual time made it, in one process.
bool is_repeatable(const Row& row);

struct Submission {
  Manifest manifest;
  std::vector<SubmittedRow> rows;
  std::vector<std::string> topologies;  ///< hashes of the descriptions of machines that it holds
};

/// Packs the rows that count (rows_to_judge()) of each experiment, with their logs and topologies, from a
/// folder of results. The manifest gets the hashes. Throws InputError that names a file that is missing.
PackedFiles submission_files(const std::string& results_folder, const std::vector<std::string>& experiments,
                             Manifest manifest);

/// Reads a submission. Adds the faults of its files to `faults`: hashes that disagree, files that do not
/// belong, rows that do not follow the schema. Throws InputError, which names `path`, if there is no readable
/// manifest.
Submission read_submission(const PackedFiles& files, const std::string& path, Faults& faults);

}  // namespace podm::bench
