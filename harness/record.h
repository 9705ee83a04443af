// The JSON line that a trial leaves behind: the mesher's own record, and around it what the harness saw.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "trial.h"

namespace podm::bench {

/// Peak resident bytes a cell beyond labels and feature transform of the image; nothing without a mesh.
std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result);

/// The row of a trial that ran, whatever came of it.
nlohmann::ordered_json make_row(const Experiment& experiment, const Trial& trial, const TrialResult& result,
                                const nlohmann::ordered_json& environment);

/// A file of JSON lines that rows are appended to; each is on the disk, whole, when append() returns.
class RecordFile {
 public:
  /// Makes the file if need be. Throws InputError naming it when it cannot be written.
  explicit RecordFile(const std::string& path);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Throws InputError naming the file and the fault; then it is as before.
  void append(const nlohmann::ordered_json& row);

 private:
  std::string path_;
  int descriptor_;
};

}  // namespace podm::bench
