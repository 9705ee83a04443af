// Files of JSON lines that survive crashes of the program and of the machine, and full disks.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "rows/row.h"

namespace podm::bench {

/// A folder of results, created if absent, into which one run writes at a time. Throws InputError that names
/// the lock file when another process holds the lock.
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
  std::vector<Row> rows;
  std::string whole;            ///< their lines, each with its end
  std::string broken;           ///< the lines that are not JSON objects, each with its end
  std::size_t broken_line = 0;  ///< number of the first broken line; 0: none
};

/// Returns all rows of a file; none if there is no file. Throws InputError "file:line: fault" for a row of an
/// unknown schema and for a row that does not follow its schema.
RowsRead read_rows(const std::string& path);

/// Moves the broken lines that a crash left to the end of FILE.broken, and reads the other lines. The caller
/// must hold the lock.
RowsRead repair_rows(const std::string& path);

/// Returns a row as its line, with the end. Bytes that are not UTF-8, which stderr may contain, are replaced.
std::string as_line(const Row& row);

/// Writes a file completely or not at all. Throws InputError that names it.
void write_file(const std::string& path, const std::string& text);

/// A file of JSON lines that rows are appended to. A row is completely on the disk when append() returns.
class RecordFile {
 public:
  /// Creates the file if absent. Throws InputError that names it when it cannot be written.
  explicit RecordFile(const std::string& path);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Throws InputError that names the file and the fault; the file is then as before.
  void append(const Row& row) { append_text(as_line(row)); }
  void append_text(const std::string& text);
  /// Replaces the newest line of each row's key by the row; other lines stay as they are. The file is
  /// replaced completely or not at all. Throws InputError that names it.
  void replace_newest(const std::vector<Row>& rows);

 private:
  std::string path_;
  int descriptor_;
};

}  // namespace podm::bench
