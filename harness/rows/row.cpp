#include "rows/row.h"

#include <algorithm>

#include "rows/codec.h"

namespace podm::bench {
namespace {

constexpr const char* kReplayFailed = "failed: ";
constexpr const char *kEqual = "equal", *kDiffers = "differs";

// Leaves the keys of the mesher's record, or of a measurement of the machine.
Json without_own_keys(Json row) {
  const auto erase = [&row](const auto& field) { row.erase(field.key); };
  std::apply([&](const auto&... fields) { (erase(fields), ...); }, Row::fields_before());
  std::apply([&](const auto&... fields) { (erase(fields), ...); }, Row::fields_after());
  return row;
}

// Adds the record's keys that the row does not have.
void add_record(const Json& record, Json& row) {
  for (const auto& [key, value] : record.items())
    if (!row.contains(key)) row[key] = value;
}

}  // namespace

double as_double(const Number& number) {
  return std::visit([](auto value) { return static_cast<double>(value); }, number);
}

const Json& asked_of(const Row& row) {
  static const Json kNothing = Json::object();
  return row.asked ? *row.asked : kNothing;
}

std::string Replay::text() const {
  return end == End::kEqual ? kEqual : end == End::kDiffers ? kDiffers : kReplayFailed + why;
}

Json Codec<Replay>::write(const Replay& replay) { return replay.text(); }

Replay Codec<Replay>::read(const Json& json, const std::string& place) {
  const auto text = from_json<std::string>(json, place);
  if (text == kEqual) return {Replay::End::kEqual, ""};
  if (text == kDiffers) return {Replay::End::kDiffers, ""};
  if (!text.starts_with(kReplayFailed))
    fail_at(place, fmt::format("must be {}, {} or \"{}\" and why", kEqual, kDiffers, kReplayFailed));
  return {Replay::End::kFailed, text.substr(std::string(kReplayFailed).size())};
}

Json Codec<Row>::write(const Row& row) {
  Json json = Json::object();
  write_fields(row, Row::fields_before(), json);
  if (row.mesh) add_record(to_json(*row.mesh), json);
  if (row.measured) add_record(to_json(*row.measured), json);
  write_fields(row, Row::fields_after(), json);
  return json;
}

Row Codec<Row>::read(const Json& json, const std::string& place) {
  if (!json.is_object()) fail_at(place, "must be an object");
  Row row;
  read_fields(json, place, Row::fields_before(), row);
  read_fields(json, place, Row::fields_after(), row);
  if (json.contains("memory_levels"))
    row.measured = from_json<MemoryLevelsRecord>(without_own_keys(json), place);
  else if (json.contains("phases_s"))
    row.mesh = from_json<MeshRecord>(without_own_keys(json), place);
  return row;
}

}  // namespace podm::bench
