// Chains of linked items. An item has one or two links, each to another item or to a hub, where several
// chains end. An item with one link is itself the end of a chain.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace podm {

using ChainLink = std::int16_t;  // an item, a hub, or nothing
inline constexpr ChainLink kNoLink = -1;
constexpr ChainLink link_to_hub(std::size_t hub) {
  return static_cast<ChainLink>(-2 - static_cast<int>(hub));
}
constexpr bool is_hub(ChainLink link) { return link < kNoLink; }
constexpr std::size_t hub_of(ChainLink link) { return static_cast<std::size_t>(-2 - link); }

struct ChainLinks {
  std::array<ChainLink, 2> links{kNoLink, kNoLink};
  bool is_walked = false;

  void add(ChainLink link) { links[links[0] == kNoLink ? 0 : 1] = link; }
  bool is_end() const { return links[1] == kNoLink; }
};

/// A chain: the links that precede and follow its items, kNoLink if the item there is the chain's end.
struct WalkedChain {
  ChainLink before = kNoLink, after = kNoLink;
  bool is_closed = false;
  std::vector<std::uint16_t> items;
};

/// Calls visit(chain) for each chain of `items`, which derive from ChainLinks, in an order given by theirs.
template <class Item, class Visit>
void for_each_chain(std::vector<Item>& items, WalkedChain& chain, const Visit& visit) {
  // Follows the links from an item, away from `from`, until the chain ends or returns to its first item.
  const auto follow = [&](std::size_t first, ChainLink from) {
    chain.items.clear();
    chain.before = from;
    chain.is_closed = false;
    auto at = static_cast<ChainLink>(first);
    while (true) {
      Item& item = items[static_cast<std::size_t>(at)];
      item.is_walked = true;
      chain.items.push_back(static_cast<std::uint16_t>(at));
      const ChainLink next = item.links[item.links[0] == from ? 1 : 0];
      from = at;
      if (next < 0 || items[static_cast<std::size_t>(next)].is_walked) {
        chain.after = next < 0 ? next : kNoLink;
        chain.is_closed = next >= 0;
        return;
      }
      at = next;
    }
  };
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].is_walked) continue;
    const auto& [a, b] = items[i].links;
    if (items[i].is_end())
      follow(i, kNoLink);
    else if (is_hub(a) || is_hub(b))
      follow(i, is_hub(a) ? a : b);
    else
      continue;
    visit(chain);
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].is_walked) continue;
    follow(i, items[i].links[0]);
    visit(chain);
  }
}

}  // namespace podm
