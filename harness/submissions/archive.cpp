#include "submissions/archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace podm::bench {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

using Reader = std::unique_ptr<archive, decltype(&archive_read_free)>;
using Writer = std::unique_ptr<archive, decltype(&archive_write_free)>;
using Entry = std::unique_ptr<archive_entry, decltype(&archive_entry_free)>;

[[noreturn]] void refuse(const std::string& path, const std::string& fault) {
  throw InputError(fmt::format("{}: {}", path, fault));
}

[[noreturn]] void refuse_bytes(const std::string& path, archive* reader) {
  const char* const fault = archive_error_string(reader);
  refuse(path, fmt::format("not a whole .tar.gz archive: {}", fault == nullptr ? "unknown fault" : fault));
}

Reader open(const std::string& path) {
  Reader reader(archive_read_new(), &archive_read_free);
  if (!reader) throw std::runtime_error("no memory for an archive");
  archive_read_support_filter_gzip(reader.get());
  archive_read_support_format_tar(reader.get());
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "no such file");
  if (archive_read_open_filename(reader.get(), path.c_str(), kBlockBytes) != ARCHIVE_OK)
    refuse_bytes(path, reader.get());
  return reader;
}

// The name is relative and has no "." or ".." in it.
bool stays_inside(const std::string& name) {
  const std::filesystem::path path(name);
  if (name.empty() || path.is_absolute()) return false;
  for (const auto& part : path)
    if (part == ".." || part == ".") return false;
  return true;
}

// Returns the name. A hard link has the type of a plain file.
std::string name_of(archive_entry* entry, const std::string& path) {
  const char* const given = archive_entry_pathname(entry);
  const std::string name = given == nullptr ? "" : given;
  const auto type = archive_entry_filetype(entry);
  if ((type != AE_IFREG && type != AE_IFDIR) || archive_entry_hardlink(entry) != nullptr)
    refuse(path, fmt::format("entry '{}' is neither a plain file nor a folder", name));
  if (!stays_inside(name))
    refuse(path, fmt::format("entry '{}' is not a plain name inside the archive", name));
  return name;
}

// The size in the entry's head may lie, therefore bytes are counted while they are read.
std::string read_file(archive* reader, const std::string& path, const std::string& name,
                      const ArchiveLimits& limits, std::size_t& bytes) {
  std::string text;
  std::array<char, kBlockBytes> block;
  while (true) {
    const auto count = archive_read_data(reader, block.data(), block.size());
    if (count < 0) refuse_bytes(path, reader);
    if (count == 0) return text;
    text.append(block.data(), static_cast<std::size_t>(count));
    bytes += static_cast<std::size_t>(count);
    if (text.size() > limits.bytes_per_file)
      refuse(path, fmt::format("'{}' unpacks to more than {} bytes", name, limits.bytes_per_file));
    if (bytes > limits.bytes) refuse(path, fmt::format("it unpacks to more than {} bytes", limits.bytes));
  }
}

void check(archive* writer, la_ssize_t result) {
  if (result < ARCHIVE_OK) throw std::runtime_error(archive_error_string(writer));
}

la_ssize_t append(archive*, void* text, const void* bytes, std::size_t size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(bytes), size);
  return static_cast<la_ssize_t>(size);
}

}  // namespace

std::string pack(const PackedFiles& files) {
  std::string bytes;
  const Writer writer(archive_write_new(), &archive_write_free);
  if (!writer) throw std::runtime_error("no memory for an archive");
  archive* const made = writer.get();
  check(made, archive_write_add_filter_gzip(made));
  check(made, archive_write_set_filter_option(made, "gzip", "timestamp", nullptr));
  check(made, archive_write_set_format_ustar(made));
  check(made, archive_write_open(made, &bytes, nullptr, &append, nullptr));
  for (const auto& [name, text] : files) {
    const Entry entry(archive_entry_new(), &archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(text.size()));
    check(made, archive_write_header(made, entry.get()));
    check(made, archive_write_data(made, text.data(), text.size()));
  }
  check(made, archive_write_close(made));
  return bytes;
}

PackedFiles unpack(const std::string& path, const ArchiveLimits& limits) {
  const Reader reader = open(path);
  PackedFiles files;
  std::size_t bytes = 0, entries = 0;
  archive_entry* entry = nullptr;
  while (true) {
    const int result = archive_read_next_header(reader.get(), &entry);
    if (result == ARCHIVE_EOF) break;
    if (result != ARCHIVE_OK) refuse_bytes(path, reader.get());
    if (++entries > limits.files) refuse(path, fmt::format("it has more than {} entries", limits.files));
    const std::string name = name_of(entry, path);
    if (archive_entry_filetype(entry) == AE_IFDIR) continue;
    std::string text = read_file(reader.get(), path, name, limits, bytes);
    if (!files.emplace(name, std::move(text)).second)
      refuse(path, fmt::format("entry '{}' is there twice", name));
  }
  if (entries == 0) refuse(path, "not a whole .tar.gz archive: it is empty");
  return files;
}

}  // namespace podm::bench
