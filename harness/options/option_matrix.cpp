#include "options/option_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "errors.h"
#include "process/share.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMaxThreads = 1024;
constexpr std::int64_t kMaxElements = std::numeric_limits<std::uint32_t>::max();
constexpr std::int64_t kMaxSeed = std::numeric_limits<std::int64_t>::max();
constexpr const char* kPerThread = "target_elements_per_thread";  // is replaced by target_elements
constexpr const char* kPerRank = "target_elements_per_rank";      // is replaced by target_elements, too
constexpr const char* kPowersOfTwo = "1..all";
constexpr const char* kLines = "lines";
constexpr const char* kMillimetres = "_mm";  // suffix of keys of lengths; options of podm have no suffix

enum class Kind {
  kPositive,
  kCount,
  kSeed,
  kWord,
  kSwitch,
  kFlag,
  kFile,
  kThreads,
  kCounters,
  kMeasure,
  kCarrier,
  kNetwork
};

struct MesherOption {
  std::string key;
  Kind kind;
  std::int64_t most = kMaxThreads;
  std::string not_on_ranks = {};  // why
};

// Options of the harness; they are not passed to a mesher.
constexpr std::array kHarnessOptions{kMesher, kSchedule, kReplay,   kFidelity, kLineDistances, kImageGrows,
                                     kSolve,  kCopies,   kCounters, kMeasure,  kRanks,         kCarrier};

// The harness supports these options for one process of podm, and not for ranks.
constexpr std::array kSingleProcessOptions{kSchedule, kReplay, kImageGrows, kCopies, kCounters, kSolve};

// Every mesher takes these options.
constexpr std::array kCommonOptions{kMesher,         "radius_mm", "delta_mm",    "delta_voxels",
                                    kTargetElements, kPerThread,  "threads",     kSolve,
                                    kLines,          kFidelity,   kLineDistances};

template <class Keys>
bool is_among(const Keys& keys, std::string_view key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

// The kind of an option as podm declares it.
Kind kind_of(const Json& option) {
  const std::string kind = option.at("kind"), key = option.at("key");
  if (key == "threads" || key == "initial_threads") return Kind::kThreads;
  if (key == "seed") return Kind::kSeed;
  if (key == "pin" || key == "oversubscribe") return Kind::kSwitch;
  if (kind == "real") return Kind::kPositive;
  if (kind == "integer") return Kind::kCount;
  if (kind == "flag") return Kind::kFlag;
  return kind == "file" ? Kind::kFile : Kind::kWord;
}

// The greatest value of an option that counts, as podm declares it.
std::int64_t most_of(const Json& option) {
  const auto most = option.find("most");
  return most != option.end() && most->is_number_integer() ? most->get<std::int64_t>() : kMaxThreads;
}

// The options of podm that experiments may set, as the program declares them: `podm options`, written by the
// build.
std::vector<MesherOption> options_of_podm() {
  const std::string path = share_of_this_program("podm_options.json");
  std::ifstream file(path);
  const Json declared = Json::parse(file, nullptr, false);
  if (!declared.is_array()) throw InputError(path + ": not the output of `podm options`");
  std::vector<MesherOption> options;
  for (const Json& option : declared)
    if (is_among(option.at("uses"), "experiments"))
      options.push_back({option.at("key"), kind_of(option), most_of(option), option.at("not_on_ranks")});
  return options;
}

// All keys that a trial may have, the mesher's name first: in this order names of trials list the keys given
// as arrays.
const std::vector<MesherOption>& mesher_options() {
  static const std::vector<MesherOption> all = [] {
    std::vector<MesherOption> options{{kMesher, Kind::kWord}};
    for (MesherOption& option : options_of_podm()) {
      const bool is_target = option.key == kTargetElements;
      options.push_back(std::move(option));
      if (is_target) options.push_back({kPerThread, Kind::kCount, kMaxElements});
      if (is_target) options.push_back({kPerRank, Kind::kCount, kMaxElements});
    }
    for (const LengthInVoxels& length : kLengthsInVoxels) options.push_back({length.key, Kind::kPositive});
    for (const char* key : {kSchedule, kReplay, kFidelity, kLineDistances, kSolve, kImageGrows})
      options.push_back({key, Kind::kFlag});
    options.push_back({kCopies, Kind::kThreads});
    options.push_back({kCounters, Kind::kCounters});
    options.push_back({kMeasure, Kind::kMeasure});
    options.push_back({kRanks, Kind::kCount});
    options.push_back({kCarrier, Kind::kCarrier});
    options.push_back({kNetwork, Kind::kNetwork});
    return options;
  }();
  return all;
}

// Returns the counts that a value stands for: "all" is the number of usable processors; "1..all" is the
// powers of two below that number, and the number.
std::vector<Json> thread_counts(const TomlValue& value, std::int64_t all) {
  if (value.as<std::string>() == nullptr) return {value.count(1, kMaxThreads)};
  const std::string text = value.text();
  if (text == "all") return {all};
  if (text != kPowersOfTwo)
    value.fail(fmt::format("{} must be an integer, \"all\" or \"{}\"", value.key, kPowersOfTwo));
  std::vector<Json> counts;
  for (std::int64_t count = 1; count < all; count *= 2) counts.push_back(count);
  counts.push_back(all);
  return counts;
}

Json switch_value(const TomlValue& value) {
  if (const auto* const flag = value.as<bool>()) return *flag;
  if (const auto* const integer = value.as<std::int64_t>()) return *integer;
  return value.text();
}

// Throws unless the name of a group has no folder in it: groups are files of one folder.
std::string counters_value(const TomlValue& value) {
  const std::string choice = value.text();
  const bool is_group = choice.starts_with(kLikwid) && choice.size() > std::strlen(kLikwid) &&
                        choice.find('/') == std::string::npos;
  if (!is_group && choice != kPerfEvent && choice != kCachegrind)
    value.fail(
        fmt::format("{} must be \"{}\", \"{}\" or \"{}GROUP\"", value.key, kPerfEvent, kCachegrind, kLikwid));
  return choice;
}

std::string word_among(const TomlValue& value, std::initializer_list<const char*> words) {
  const std::string text = value.text();
  if (std::find(words.begin(), words.end(), text) == words.end())
    value.fail(fmt::format("{} must be one of {}", value.key, fmt::join(words, ", ")));
  return text;
}

std::string network_value(const TomlValue& value) {
  const std::string network = value.text();
  double latency_us = -1, gb_per_s = -1;
  char more = 0;
  if (std::sscanf(network.c_str(), "%lf,%lf%c", &latency_us, &gb_per_s, &more) != 2 || !(latency_us > 0) ||
      !(gb_per_s > 0) || std::isinf(latency_us) || std::isinf(gb_per_s))
    value.fail(fmt::format("{} must be \"MICROSECONDS,GB_PER_S\", such as \"2,12.5\"", value.key));
  return network;
}

std::vector<Json> read_value(const TomlValue& value, const MesherOption& option,
                             const MatrixContext& context) {
  switch (option.kind) {
    case Kind::kPositive:
      return {value.positive()};
    case Kind::kCount:
      return {value.count(1, option.most)};
    case Kind::kSeed:
      return {value.count(0, kMaxSeed)};
    case Kind::kWord:
      return {value.text()};
    case Kind::kSwitch:
      return {switch_value(value)};
    case Kind::kFlag:
      return {value.flag()};
    case Kind::kFile:
      return {(std::filesystem::path(context.folder) / value.text()).lexically_normal().string()};
    case Kind::kCounters:
      return {counters_value(value)};
    case Kind::kMeasure:
      return {word_among(value, {kMemoryLatency})};
    case Kind::kCarrier:
      return {word_among(value, {kMpi, kInProcess})};
    case Kind::kNetwork:
      return {network_value(value)};
    case Kind::kThreads:
      break;
  }
  return thread_counts(value, context.processors);
}

void multiply(std::vector<Variant>& variants, const std::string& key, const std::vector<Json>& values,
              bool in_suffix) {
  std::vector<Variant> product;
  for (const Variant& variant : variants)
    for (const Json& value : values) {
      product.push_back(variant);
      product.back().options[key] = value;
      if (in_suffix) product.back().suffix += fmt::format(",{}={}", key, in_name(value));
    }
  variants = std::move(product);
}

// Returns the values of an option, each once: on two processors [1, 2, "all"] gives 1, 2.
std::vector<Json> read_values(TomlSection& section, const MesherOption& option,
                              const MatrixContext& context) {
  std::vector<Json> values;
  for (const TomlValue& given : section.values(option.key))
    for (Json& value : read_value(given, option, context))
      if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(std::move(value));
  return values;
}

// A text must not look like another option.
bool has_type_of(Kind kind, const Json& value) {
  const bool is_word =
      value.is_string() && !value.get<std::string>().starts_with('-') && in_name(value) == value;
  switch (kind) {
    case Kind::kPositive:
      return value.is_number() && value > 0;
    case Kind::kCount:
    case Kind::kSeed:
    case Kind::kThreads:
      return value.is_number_unsigned();
    case Kind::kFlag:
      return value.is_boolean();
    case Kind::kSwitch:
      return value.is_boolean() || value.is_number_unsigned() || is_word;
    default:
      return is_word;
  }
}

void refuse_second_size(const TomlSection& section) {
  std::vector<const char*> given;
  for (const char* key : {"radius_mm", kTargetElements, kPerThread, kPerRank})
    if (section.has(key)) given.push_back(key);
  if (given.size() > 1)
    section.fail(given.back(), fmt::format("{} exclude each other", fmt::join(given, " and ")));
}

void refuse_second_length(const TomlSection& section) {
  for (const auto& [key, key_in_mm] : kLengthsInVoxels)
    if (section.has(key) && section.has(key_in_mm))
      section.fail(key, fmt::format("{} and {} exclude each other", key_in_mm, key));
  for (const char* target : {kTargetElements, kPerThread, kPerRank})  // its radius comes with a delta
    if (section.has("delta_voxels") && section.has(target))
      section.fail("delta_voxels", fmt::format("{} and delta_voxels exclude each other", target));
}

void refuse_options_of_podm(const TomlSection& section, const Json& options) {
  if (options.value(kMesher, kPodm) == kPodm) return;
  for (const auto& [key, value] : options.items())
    if (!is_among(kCommonOptions, key)) section.fail(key, fmt::format("{} is an option of podm only", key));
}

void refuse_options_of_meshers(const TomlSection& section, const Json& options) {
  if (!options.contains(kMeasure)) return;
  for (const MesherOption& option : mesher_options())
    if (option.kind != Kind::kMeasure && section.has(option.key))
      section.fail(option.key, fmt::format("{} is an option of meshers", option.key));
}

// Each copy is bound to one processor, and the kernel counts all copies together. Copies therefore exclude
// several threads, pinning and counters.
void refuse_options_excluded_by_copies(const TomlSection& section, const Json& options) {
  if (!options.contains(kCopies)) return;
  if (options["threads"] != 1) section.fail(kCopies, "copies need threads = 1");
  for (const char* key : {"pin", kCounters})
    if (options.contains(key)) section.fail(key, fmt::format("{} and {} exclude each other", kCopies, key));
}

void refuse_options_excluded_by_ranks(const TomlSection& section, const Json& options) {
  const auto need = [&](const char* key, const char* needed, bool is_there) {
    if (options.contains(key) && !is_there) section.fail(key, fmt::format("{} needs {}", key, needed));
  };
  need(kRanks, kCarrier, options.contains(kCarrier));
  need(kCarrier, kRanks, options.contains(kRanks));
  need(kPerRank, kRanks, options.contains(kRanks));
  need(kNetwork, "ranks of carrier \"in-process\"", options.value(kCarrier, "") == kInProcess);
  if (options.value(kCarrier, "") == kMpi && options.value("executor", "") == "virtual")
    section.fail("executor", "virtual time of ranks needs carrier \"in-process\"");
  if (!options.contains(kRanks)) return;
  for (const MesherOption& option : mesher_options())
    if (options.contains(option.key) &&
        (is_among(kSingleProcessOptions, option.key) || !option.not_on_ranks.empty()) &&
        option.key != kTargetElements)  // podm finds the radius before the ranks run
      section.fail(option.key, fmt::format("{} and {} exclude each other", kRanks, option.key));
}

void scale_by(const char* key, const char* number, const TomlSection& section, Json& options) {
  if (!options.contains(key)) return;
  const std::int64_t elements = options[key].get<std::int64_t>() * options[number].get<std::int64_t>();
  if (elements > kMaxElements)
    section.fail(key, fmt::format("{} elements in all, more than {}", elements, kMaxElements));
  options.erase(key);
  options[kTargetElements] = elements;
}

}  // namespace

std::string in_name(const Json& value) {
  std::string text = value.is_string() ? std::filesystem::path(value.get<std::string>()).filename().string()
                     : value.is_number_float() ? fmt::format("{}", value.get<double>())
                                               : value.dump();
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') c = '_';
  return text;
}

std::vector<Variant> read_matrix(TomlSection& section, const MatrixContext& context) {
  refuse_second_size(section);
  refuse_second_length(section);
  std::vector<Variant> variants{{"", {{"threads", 1}}}};
  for (const MesherOption& option : mesher_options()) {
    const std::vector<Json> values = read_values(section, option, context);
    const bool in_suffix = section.is_array(option.key) || section.is_text(option.key, kPowersOfTwo);
    if (!values.empty()) multiply(variants, option.key, values, in_suffix);
  }
  for (Variant& variant : variants) {
    refuse_options_of_meshers(section, variant.options);
    refuse_options_of_podm(section, variant.options);
    refuse_options_excluded_by_copies(section, variant.options);
    refuse_options_excluded_by_ranks(section, variant.options);
    scale_by(kPerThread, "threads", section, variant.options);
    scale_by(kPerRank, kRanks, section, variant.options);
  }
  return variants;
}

std::string fault_of_options(const Json& options) {
  if (!options.is_object()) return "not an object";
  const std::vector<MesherOption>& known = mesher_options();
  for (const auto& [key, value] : options.items()) {
    const auto option = std::ranges::find(known, key, &MesherOption::key);
    if (option == known.end()) return fmt::format("'{}' is no option of a trial", key);
    if (option->kind == Kind::kFile) return fmt::format("'{}' names a file", key);
    if (!has_type_of(option->kind, value)) return fmt::format("'{}' has a value of another type", key);
  }
  return "";
}

std::vector<std::string> mesher_arguments(const Json& options) {
  std::vector<std::string> arguments;
  for (const auto& [key, value] : options.items()) {
    if (value == false || is_among(kHarnessOptions, key)) continue;
    std::string name = key.ends_with(kMillimetres) ? key.substr(0, key.size() - 3) : key;
    std::replace(name.begin(), name.end(), '_', '-');
    arguments.push_back("--" + name);
    if (value.is_string()) arguments.push_back(value);
    if (value.is_number_float()) arguments.push_back(fmt::format("{}", value.get<double>()));
    if (value.is_number_integer()) arguments.push_back(value.dump());
  }
  return arguments;
}

}  // namespace podm::bench
