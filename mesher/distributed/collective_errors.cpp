#include "distributed/collective_errors.h"

#include <algorithm>

#include "distributed/messages.h"

namespace podm {
namespace {

Bytes bytes_of(const std::vector<std::string>& texts) {
  Bytes message;
  for (const std::string& text : texts) append(message, std::span<const char>(text));
  return message;
}

std::vector<std::string> read_texts(const Bytes& message, std::size_t count) {
  MessageReader reader(message);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<char> text = reader.read<char>();
    texts.emplace_back(text.begin(), text.end());
  }
  return texts;
}

}  // namespace

void do_collectively(const std::function<void()>& action, Communication& ranks) {
  std::string fault;
  try {
    action();
  } catch (const InputError& error) {
    fault = error.what();
  }
  std::vector<std::string> faults;
  for (const Bytes& message : ranks.all_gather(bytes_of({fault})))
    faults.push_back(read_texts(message, 1)[0]);
  const auto first =
      std::find_if(faults.begin(), faults.end(), [](const auto& text) { return !text.empty(); });
  if (first == faults.end()) return;
  if (std::count(faults.begin(), faults.end(), *first) == ranks.size()) throw RefusedByAll(*first);
  throw RefusedByAll(fmt::format("rank {} of {}: {}", first - faults.begin(), ranks.size(), *first));
}

void expect_agreement(const std::vector<Fact>& facts, Communication& ranks) {
  std::vector<std::string> own;
  for (const auto& [name, text] : facts) own.push_back(text);
  const std::vector<Bytes> all = ranks.all_gather(bytes_of(own));
  const std::vector<std::string> of_first = read_texts(all[0], own.size());
  for (std::size_t rank = 1; rank < all.size(); ++rank) {
    const std::vector<std::string> texts = read_texts(all[rank], own.size());
    for (std::size_t i = 0; i < texts.size(); ++i)
      if (texts[i] != of_first[i])
        throw RefusedByAll(fmt::format("rank {} of {} does not have the {} of rank 0: {}, not {}", rank,
                                       ranks.size(), facts[i].first, texts[i], of_first[i]));
  }
}

}  // namespace podm
