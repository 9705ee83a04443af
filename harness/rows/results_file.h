// Files of JSON lines that outlive a crash of the program, of the machine, and full disks.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "errors.h"

namespace podm::bench {

/// A folder of results, made if need be, that one run at a time writes into. Throws InputError naming the
/// lock's file when another process holds it.
class ResultsLock {
 public:
  explicit ResultsLock(const std::string& folder);
  ~ResultsLock();
  ResultsLock(const ResultsLock&) = delete;
  ResultsLock& operator=(const ResultsLock&) = delete;

 private:
  int descriptor_;
};

struct RowsRead {
  std::vector<nlohmann::ordered_json> rows;
  std::string whole;            ///< their lines, each ended
  std::string broken;           ///< the lines that are no JSON object, each ended
  std::size_t broken_line = 0;  ///< the number of the first of them; 0: none
};

/// All rows of a file; none when there is no file. Throws InputError "file:line: fault" on a row of a schema
/// that this program does not know.
RowsRead read_rows(const std::string& path);

/// The same, once the broken lines, left by a crash, have been moved to the end of FILE.broken. Needs the
/// lock.
RowsRead repair_rows(const std::string& path);

/// Writes a file whole or not at all. Throws InputError naming it.
void write_file(const std::string& path, const std::string& text);

/// A file of JSON lines that rows are appended to; each is on the disk, whole, when append() returns.
class RecordFile {
 public:
  /// Makes the file if need be. Throws InputError naming it when it cannot be written.
  explicit RecordFile(const std::string& path);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Throws InputError naming the file and the fault; then it is as before.
  void append(const nlohmann::ordered_json& row) { append_text(as_line(row)); }
  void append_text(const std::string& text);

 private:
  static std::string as_line(const nlohmann::ordered_json& row);

  std::string path_;
  int descriptor_;
};

}  // namespace podm::bench
