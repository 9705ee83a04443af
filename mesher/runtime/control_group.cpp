#include "runtime/control_group.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

namespace podm {

namespace {

struct Mount {
  std::string root, point, type, options;
};

bool lists(const std::string& names, const std::string& name) {
  return ("," + names + ",").find("," + name + ",") != std::string::npos;
}

// Mountinfo writes blanks and backslashes as a backslash and three octal digits.
std::string unescaped(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 3 < text.size()) {
      plain += static_cast<char>(std::stoi(text.substr(i + 1, 3), nullptr, 8));
      i += 3;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

// "36 35 0:30 / /sys/fs/cgroup rw shared:9 - cgroup2 cgroup2 rw"
std::optional<Mount> parse_mount(const std::string& line) {
  const auto dash = line.find(" - ");
  if (dash == std::string::npos) return {};
  std::istringstream before(line.substr(0, dash)), after(line.substr(dash + 3));
  std::string ignored, root, point, type, source, options;
  before >> ignored >> ignored >> ignored >> root >> point;
  after >> type >> source >> options;
  return Mount{unescaped(root), unescaped(point), type, options};
}

bool is_in_tree(const std::string& group, const std::string& tree) {
  return tree == "/" || group == tree || group.starts_with(tree + "/");
}

// Returns the mount that shows most of the groups around `group`, among the mounts that show `group`. Groups
// of other processes may be mounted as well; they count only if no mount shows `group`, as in containers that
// see other paths.
std::optional<Mount> find_mount(const std::string& root, const std::string& type,
                                const std::string& controller, const std::string& group) {
  std::ifstream file(root + "/proc/self/mountinfo");
  std::optional<Mount> best;
  for (std::string line; std::getline(file, line);) {
    const auto mount = parse_mount(line);
    if (!mount || mount->type != type || !(controller.empty() || lists(mount->options, controller))) continue;
    const bool shows_it = is_in_tree(group, mount->root),
               best_shows_it = best && is_in_tree(group, best->root);
    if (!best || (shows_it && (!best_shows_it || mount->root.size() < best->root.size()))) best = mount;
  }
  return best;
}

// Returns the path of this process's group in the hierarchy that has the controller; without a controller, in
// the hierarchy of version 2. The lines are like "4:memory:/some/group".
std::optional<std::string> group_path(const std::string& root, const std::string& controller) {
  std::ifstream file(root + "/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (controller.empty() ? controllers.empty() : lists(controllers, controller))
      return line.substr(second + 1);
  }
  return {};
}

// Returns the folder of the group and the folders around it, up to the mount point. A container may see only
// a part of the path.
std::vector<std::string> folders_of(const std::string& root, const Mount& mount, const std::string& group) {
  std::string inside = group;
  if (mount.root != "/") inside = is_in_tree(group, mount.root) ? group.substr(mount.root.size()) : "";
  std::vector<std::string> folders;
  for (std::filesystem::path path(inside); path.has_relative_path(); path = path.parent_path())
    if (const std::string folder = root + mount.point + path.string(); std::filesystem::exists(folder))
      folders.push_back(folder);
  folders.push_back(root + mount.point);
  return folders;
}

// Reads one number; none if the file is missing or contains "max".
std::optional<std::uint64_t> read_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  if (file >> number) return number;
  return {};
}

// Returns the number beside `key` in a file of such lines; 0 if there is none.
std::uint64_t read_value(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  for (std::string name; file >> name >> value;)
    if (name == key) return value;
  return 0;
}

// Version 1 writes a number near 2^63 if there is no limit. Above memory.high the kernel reclaims memory and
// throttles the process, which ends meshing as well.
std::uint64_t memory_limit_of(const std::string& folder, bool is_unified) {
  constexpr std::uint64_t kNone = std::uint64_t{1} << 62;
  std::uint64_t least = kNoLimit;
  const std::vector<const char*> unified{"/memory.max", "/memory.high"}, legacy{"/memory.limit_in_bytes"};
  for (const char* file : is_unified ? unified : legacy)
    if (const auto most = read_number(folder + file); most && *most < kNone) least = std::min(least, *most);
  return least;
}

std::uint64_t memory_left_in(const std::string& folder, bool is_unified) {
  const std::uint64_t most = memory_limit_of(folder, is_unified);
  const auto used = read_number(folder + (is_unified ? "/memory.current" : "/memory.usage_in_bytes"));
  if (most == kNoLimit || !used) return kNoLimit;
  const std::uint64_t droppable =
      read_value(folder + "/memory.stat", is_unified ? "inactive_file" : "total_inactive_file");
  const std::uint64_t needed = *used - std::min(*used, droppable);
  return most - std::min(most, needed);
}

template <class BytesIn>
std::uint64_t least_of_groups(const std::string& root, const BytesIn& bytes_in) {
  const ControlGroup groups = control_group_of("memory", root);
  std::uint64_t least = kNoLimit;
  for (const std::string& folder : groups.folders)
    least = std::min(least, bytes_in(folder, groups.is_unified));
  return least;
}

}  // namespace

ControlGroup control_group_of(const std::string& controller, const std::string& root) {
  if (const auto group = group_path(root, controller))
    if (const auto mount = find_mount(root, "cgroup", controller, *group))
      return {folders_of(root, *mount, *group), false};
  if (const auto group = group_path(root, ""))
    if (const auto mount = find_mount(root, "cgroup2", "", *group))
      return {folders_of(root, *mount, *group), true};
  return {};
}

std::uint64_t memory_limit_of_control_groups(const std::string& root) {
  return least_of_groups(root, memory_limit_of);
}

std::uint64_t memory_left_in_control_groups(const std::string& root) {
  return least_of_groups(root, memory_left_in);
}

}  // namespace podm
