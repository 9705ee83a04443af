#include "runtime/placement.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <tuple>

namespace podm {

namespace {

constexpr int kMaxProcessors = 8192;  // the maximum that Linux is built for

using ProcessorSet = std::array<cpu_set_t, kMaxProcessors / CPU_SETSIZE>;

// Returns the number that the whole text spells.
std::optional<int> parse_os_index(std::string_view text) {
  int value = -1;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || value < 0 || value >= kMaxProcessors) return {};
  return value;
}

[[noreturn]] void refuse_piece(std::string_view plan, std::string_view piece, std::string_view fault) {
  throw PlacementError(
      fmt::format("pin plan \"{}\": \"{}\" {}; allowed are compact, scatter, none, or "
                  "processors below {} such as 0,2,4-7",
                  plan, piece, fault, kMaxProcessors));
}

std::vector<int> parse_list(std::string_view plan) {
  std::vector<int> os_indices;
  for (std::size_t begin = 0; begin <= plan.size();) {
    const std::string_view piece = plan.substr(begin, plan.find(',', begin) - begin);
    const std::size_t dash = piece.find('-');
    const auto first = parse_os_index(piece.substr(0, dash));
    const auto last = dash == piece.npos ? first : parse_os_index(piece.substr(dash + 1));
    if (!first || !last) refuse_piece(plan, piece, "is not a processor or a range");
    if (*last < *first) refuse_piece(plan, piece, "has its ends in the wrong order");
    for (int os_index = *first; os_index <= *last; ++os_index) {
      if (std::count(os_indices.begin(), os_indices.end(), os_index) != 0)
        refuse_piece(plan, piece, fmt::format("repeats processor {}", os_index));
      os_indices.push_back(os_index);
    }
    begin += piece.size() + 1;
  }
  return os_indices;
}

std::vector<Processor> listed_processors(const Topology& machine, const std::vector<int>& os_indices) {
  std::map<int, Processor> by_os_index;
  for (const Processor& processor : machine.processors()) by_os_index[processor.os_index] = processor;
  std::vector<Processor> listed;
  for (const int os_index : os_indices) {
    const auto found = by_os_index.find(os_index);
    if (found == by_os_index.end())
      throw PlacementError(fmt::format("pin plan: processor {} is not one of the {} usable processors",
                                       os_index, by_os_index.size()));
    listed.push_back(found->second);
  }
  return listed;
}

// Returns the processors in the order in which workers take them.
std::vector<Processor> processors_in_order(const Topology& machine, const PinPlan& plan) {
  if (plan.kind == PinPlan::Kind::kList) return listed_processors(machine, plan.os_indices);
  std::vector<Processor> order = machine.processors();
  if (plan.kind == PinPlan::Kind::kCompact) {
    std::stable_sort(order.begin(), order.end(), [](const Processor& a, const Processor& b) {
      return std::tie(a.node, a.thread, a.core) < std::tie(b.node, b.thread, b.core);
    });
    return order;
  }
  std::map<std::pair<int, int>, std::map<int, int>> turns;  // by node and thread: per core, its turn
  for (const Processor& p : order) {
    auto& cores = turns[{p.node, p.thread}];
    cores.emplace(p.core, static_cast<int>(cores.size()));
  }
  const auto key = [&](const Processor& p) {
    return std::tuple(p.thread, turns.at({p.node, p.thread}).at(p.core), p.node);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Processor& a, const Processor& b) { return key(a) < key(b); });
  return order;
}

}  // namespace

PinPlan PinPlan::parse(std::string_view text) {
  if (text == "compact") return {Kind::kCompact, {}};
  if (text == "scatter") return {Kind::kScatter, {}};
  if (text == "none") return {Kind::kNone, {}};
  return {Kind::kList, parse_list(text)};
}

std::vector<Place> place_workers(const Topology& machine, const PinPlan& plan, int num_workers,
                                 bool oversubscribe) {
  const std::vector<Processor> order = processors_in_order(machine, plan);
  const auto num_processors = static_cast<int>(order.size());
  if (num_workers > num_processors && !oversubscribe)
    throw PlacementError(fmt::format(
        "{} workers, but {} {}; use fewer workers, or the option oversubscribe to share processors",
        num_workers, num_processors,
        plan.kind == PinPlan::Kind::kList ? "processors in the pin plan" : "usable processors"));
  std::vector<Place> places;
  for (int worker = 0; worker < num_workers; ++worker) {
    const Processor& processor = order[worker % num_processors];
    places.push_back({processor.os_index, processor.node, processor.socket});
    if (plan.kind == PinPlan::Kind::kNone) places.back().processor.reset();
  }
  return places;
}

namespace {

void bind_this_thread(const std::vector<int>& os_indices) {
  ProcessorSet set{};
  for (const int os_index : os_indices) {
    if (os_index < 0 || os_index >= kMaxProcessors)
      throw PlacementError(fmt::format("processor {}: no such processor", os_index));
    CPU_SET_S(os_index, sizeof set, set.data());
  }
  if (sched_setaffinity(0, sizeof set, set.data()) != 0)
    throw PlacementError(fmt::format("processor {}: cannot bind a thread to it: {}", os_indices.front(),
                                     std::strerror(errno)));
}

}  // namespace

std::vector<int> processors_of_this_thread() {
  ProcessorSet set{};
  if (sched_getaffinity(0, sizeof set, set.data()) != 0)
    throw PlacementError(fmt::format("cannot read the processors of a thread: {}", std::strerror(errno)));
  std::vector<int> os_indices;
  for (int os_index = 0; os_index < kMaxProcessors; ++os_index)
    if (CPU_ISSET_S(os_index, sizeof set, set.data())) os_indices.push_back(os_index);
  return os_indices;
}

void pin_this_thread(int os_index) { bind_this_thread({os_index}); }

ScopedBinding::ScopedBinding(std::optional<int> os_index) {
  if (!os_index) return;
  before_ = processors_of_this_thread();
  pin_this_thread(*os_index);
}

ScopedBinding::~ScopedBinding() {
  if (before_.empty()) return;
  try {
    bind_this_thread(before_);
  } catch (const PlacementError&) {
    // Processors were taken away meanwhile: the thread stays where it is.
  }
}

ThreadProcessor processor_of_this_thread() {
  const std::vector<int> os_indices = processors_of_this_thread();
  return {os_indices.size() == 1 ? std::optional(os_indices.front()) : std::nullopt, sched_getcpu()};
}

}  // namespace podm
