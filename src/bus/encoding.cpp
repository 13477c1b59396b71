#include "encoding.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <pilotfish/command_t.hpp>

namespace pilotfish::bus {
namespace {

static_assert(static_cast<int>(Status::searching) == command_t::STATUS_SEARCHING);
static_assert(static_cast<int>(Status::tracking) == command_t::STATUS_TRACKING);
static_assert(static_cast<int>(Status::coasting) == command_t::STATUS_COASTING);
static_assert(static_cast<int>(Status::lost) == command_t::STATUS_LOST);
static_assert(static_cast<int>(Status::stopped) == command_t::STATUS_STOPPED);
static_assert(static_cast<int>(Status::invalid_input) == command_t::STATUS_INVALID_INPUT);

/// A string is its length, its letters and a zero; then comes the count.
std::size_t size_of(const counter_t& counter) { return 4 + counter.name.size() + 1 + 8; }

}  // namespace

bool is_known(int status, int reason) {
  return status >= 0 && status <= command_t::STATUS_INVALID_INPUT && reason >= 0 &&
         reason < static_cast<int>(kReasons.size());
}

std::string words(Status status, Reason reason) {
  std::string text(to_string(status));
  if (reason != Reason::none) text.append(": ").append(to_string(reason));
  return text;
}

/// A page of a long list is what fits; page after page, a few messages contain every name.
std::vector<counter_t> encode(const Counters& counters, std::size_t at_most, std::size_t size_bytes, std::size_t turn) {
  std::vector<std::vector<counter_t>> pages(1);
  const auto fits = [&](const std::vector<counter_t>& page, std::size_t count, std::size_t room_bytes) {
    const std::size_t used = std::accumulate(page.begin(), page.end(), std::size_t{0},
                                             [](std::size_t sum, const counter_t& c) { return sum + size_of(c); });
    return page.size() <= count && used <= room_bytes;
  };
  for (const auto& [name, count] : counters) pages[0].push_back({name.substr(0, kMaxCounterName), count});
  if (fits(pages[0], at_most, size_bytes)) return pages[0];

  counter_t others{"others", 0};
  const std::vector<counter_t> all = std::exchange(pages[0], {});
  for (const counter_t& counter : all) {
    pages.back().push_back(counter);
    if (fits(pages.back(), at_most - 1, size_bytes - size_of(others))) continue;
    pages.back().pop_back();
    pages.push_back({counter});
  }
  std::vector<counter_t>& page = pages[turn % pages.size()];
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();  // where their sum stops
  for (const std::vector<counter_t>& other : pages)
    if (&other != &page)
      for (const counter_t& hidden : other)
        others.count = others.count > kMax - hidden.count ? kMax : others.count + hidden.count;
  page.push_back(others);
  return page;
}

bool skip_counters(WireReader& reader, std::int32_t at_most) {
  std::int32_t count = 0;
  if (!reader.read(count) || count < 0 || count > at_most) return false;
  for (std::int32_t i = 0; i < count; ++i)
    if (!reader.skip_string(kMaxCounterName) || !reader.skip(8)) return false;
  return true;
}

Counters decode(const std::vector<counter_t>& messages) {
  Counters counters;
  for (const counter_t& message : messages) counters[message.name] = message.count;
  return counters;
}

}  // namespace pilotfish::bus
