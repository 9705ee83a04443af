// Files of JSON lines that outlive a crash of the program, of the machine, and full disks.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "rows/row.h"

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
  std::vector<Row> rows;
  std::string whole;            ///< their lines, each ended
  std::string broken;           ///< the lines that are no JSON object, each ended
  std::size_t broken_line = 0;  ///< the number of the first of them; 0: none
};

/// All rows of a file; none when there is no file. Throws InputError "file:line: fault" on a row of a schema
/// that this program does not know and on one that is not as its schema says.
RowsRead read_rows(const std::string& path);

/// Moves the broken lines, which a crash left, to the end of FILE.broken and reads the others. The caller
/// holds the lock.
RowsRead repair_rows(const std::string& path);

/// A row as its line, ended. What is not UTF-8, which stderr may hold, is replaced.
std::string as_line(const Row& row);

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
  void append(const Row& row) { append_text(as_line(row)); }
  void append_text(const std::string& text);
  /// Writes these rows in the place of the newest line of the same key, each; other lines stay as they are.
  /// The file is replaced whole or not at all. Throws InputError naming it.
  void replace_newest(const std::vector<Row>& rows);

 private:
  std::string path_;
  int descriptor_;
};

}  // namespace podm::bench
