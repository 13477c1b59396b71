#include "reassembly.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

constexpr std::uint32_t kShort = 0x4c433032, kFragment = 0x4c433033;  // "LC02", "LC03"
constexpr std::size_t kShortHeader = 8, kFragmentHeader = 20, kMaxChannelLetters = 63;
/// What a part behind a gap takes beside its bytes; many of one byte each must not slip under the limit.
constexpr std::size_t kPartOverhead = 128;
/// Reserved at once for a message that announces as much; not touched before the bytes arrive.
constexpr std::size_t kMaxReserve = 4 << 20;

/// The text up to the zero that ends it; empty if there is none within the letters that a channel may have.
std::string_view channel_at(const std::uint8_t* bytes, std::size_t size_bytes) {
  const void* zero = size_bytes == 0 ? nullptr : std::memchr(bytes, 0, std::min(size_bytes, kMaxChannelLetters + 1));
  if (zero == nullptr) return {};
  const char* text = reinterpret_cast<const char*>(bytes);
  return {text, static_cast<std::size_t>(static_cast<const char*>(zero) - text)};
}

}  // namespace

struct Reassembly::Fragment {
  Key key;
  std::uint32_t message_bytes = 0, offset = 0;
  std::uint16_t number = 0, fragments = 0;
  std::string_view channel;  ///< of number 0 only
  const std::uint8_t* part = nullptr;
  std::size_t part_bytes = 0;

  std::size_t end() const { return offset + part_bytes; }
};

bool Reassembly::Key::operator==(const Key& other) const {
  return sequence == other.sequence && sender.address == other.sender.address && sender.port == other.sender.port;
}

Reassembly::Reassembly(Count count, const ReassemblyLimits& limits) : count_(std::move(count)), limits_(limits) {}

std::optional<WireMessage> Reassembly::take(const std::uint8_t* datagram, std::size_t size_bytes, Sender sender,
                                            MonotonicTime arrival) {
  WireReader reader(datagram, size_bytes);
  std::uint32_t magic = 0;
  Fragment fragment;
  fragment.key.sender = sender;
  if (!reader.read(magic) || !reader.read(fragment.key.sequence) || (magic != kShort && magic != kFragment)) {
    count_("datagram_not_lcm", 1);
    return std::nullopt;
  }
  if (magic == kShort) return take_short(datagram + kShortHeader, size_bytes - kShortHeader, arrival);

  if (!reader.read(fragment.message_bytes) || !reader.read(fragment.offset) || !reader.read(fragment.number) ||
      !reader.read(fragment.fragments)) {
    count_("datagram_not_lcm", 1);
    return std::nullopt;
  }
  fragment.part = datagram + kFragmentHeader;
  fragment.part_bytes = size_bytes - kFragmentHeader;
  if (fragment.number == 0) {
    fragment.channel = channel_at(fragment.part, fragment.part_bytes);
    if (fragment.channel.empty()) {
      count_("datagram_channel_bad", 1);
      return std::nullopt;
    }
    fragment.part += fragment.channel.size() + 1;
    fragment.part_bytes -= fragment.channel.size() + 1;
  }
  std::string_view refusal;
  if (fragment.message_bytes > limits_.max_message_bytes)
    refusal = "message_too_large";
  else if (fragment.end() > fragment.message_bytes)  // 64 bits: an offset of 2^32 - 1 does not wrap
    refusal = "fragment_out_of_bounds";
  else if (fragment.number >= fragment.fragments || fragment.fragments > fragment.message_bytes ||
           fragment.part_bytes == 0 || (fragment.number == 0) != (fragment.offset == 0))
    refusal = "fragment_header_bad";
  if (refusal.empty()) return take_fragment(fragment, arrival);
  count_(refusal, 1);
  return std::nullopt;
}

std::optional<WireMessage> Reassembly::take_short(const std::uint8_t* rest, std::size_t size_bytes,
                                                  MonotonicTime arrival) {
  const std::string_view channel = channel_at(rest, size_bytes);
  if (channel.empty()) {
    count_("datagram_channel_bad", 1);
    return std::nullopt;
  }
  if (!is_subscribed(channel)) return std::nullopt;
  return WireMessage{std::string(channel),
                     std::make_shared<const std::vector<std::uint8_t>>(rest + channel.size() + 1, rest + size_bytes),
                     arrival};
}

std::optional<WireMessage> Reassembly::take_fragment(const Fragment& fragment, MonotonicTime arrival) {
  expire(arrival);
  auto message = std::find_if(unfinished_.begin(), unfinished_.end(),
                              [&](const Unfinished& candidate) { return candidate.key == fragment.key; });
  if (message != unfinished_.end()) {
    const std::string_view refusal = add(*message, fragment);
    if (refusal.empty()) {
      message->arrival = std::min(message->arrival, arrival);
      return finish_if_whole(message);
    }
    if (refusal == "fragment_repeated") {
      count_(refusal, 1);
      return std::nullopt;
    }
    drop(message, refusal);
    if (fragment.number != 0) return std::nullopt;  // only a fragment 0 may begin another under the same number
  }
  if (!may_begin(fragment)) return std::nullopt;
  message = begin(fragment, arrival);
  const std::string_view refusal = add(*message, fragment);
  if (refusal.empty()) return finish_if_whole(message);
  drop(message, refusal);
  return std::nullopt;
}

std::string_view Reassembly::compare(const Unfinished& message, const Fragment& fragment) const {
  if (message.message_bytes != fragment.message_bytes || message.fragments != fragment.fragments)
    return "fragment_mismatch";
  const auto is_same_as = [&](const std::uint8_t* there) {
    return std::memcmp(there, fragment.part, fragment.part_bytes) == 0;
  };
  if (fragment.number == 0 && !message.channel.empty() && message.channel != fragment.channel)
    return "fragment_overlap";
  if (fragment.offset < message.payload.size())
    return fragment.end() <= message.payload.size() && is_same_as(message.payload.data() + fragment.offset)
               ? "fragment_repeated"
               : "fragment_overlap";
  const auto behind = message.ahead.lower_bound(fragment.offset);
  if (behind != message.ahead.end() && behind->first < fragment.end())
    return behind->first == fragment.offset && behind->second.size() == fragment.part_bytes &&
                   is_same_as(behind->second.data())
               ? "fragment_repeated"
               : "fragment_overlap";
  if (behind != message.ahead.begin()) {
    const auto& [offset, part] = *std::prev(behind);
    if (offset + part.size() > fragment.offset) return "fragment_overlap";
  }
  return {};
}

std::string_view Reassembly::add(Unfinished& message, const Fragment& fragment) {
  if (const std::string_view refusal = compare(message, fragment); !refusal.empty()) return refusal;
  if (fragment.number == 0) message.channel = fragment.channel;
  const bool in_order = fragment.offset == message.payload.size();
  const std::size_t cost_bytes = fragment.part_bytes + (in_order ? 0 : kPartOverhead);
  if (!make_room(message, cost_bytes)) return "message_displaced";
  message.held_bytes += cost_bytes;
  held_bytes_ += cost_bytes;
  ++message.received;
  if (!in_order) {
    message.ahead.emplace(fragment.offset,
                          std::vector<std::uint8_t>(fragment.part, fragment.part + fragment.part_bytes));
    return {};
  }
  if (message.payload.empty()) message.payload.reserve(std::min<std::size_t>(message.message_bytes, kMaxReserve));
  message.payload.insert(message.payload.end(), fragment.part, fragment.part + fragment.part_bytes);
  while (!message.ahead.empty() && message.ahead.begin()->first == message.payload.size()) {
    const auto& part = message.ahead.begin()->second;
    message.payload.insert(message.payload.end(), part.begin(), part.end());
    message.ahead.erase(message.ahead.begin());
    message.held_bytes -= kPartOverhead;
    held_bytes_ -= kPartOverhead;
  }
  return {};
}

bool Reassembly::may_begin(const Fragment& fragment) {
  Closed* const known = closed(fragment.key);
  if (fragment.number != 0) {
    if (known != nullptr && known->wanted) count_("fragment_late", 1);
    return known == nullptr;
  }
  if (!is_subscribed(fragment.channel)) {
    close(fragment.key, false);
    return false;
  }
  if (known != nullptr) known->used = false;
  return true;
}

Reassembly::Messages::iterator Reassembly::begin(const Fragment& fragment, MonotonicTime arrival) {
  const Sender sender = fragment.key.sender;
  const auto is_senders = [&](const Unfinished& message) {
    return message.key.sender.address == sender.address && message.key.sender.port == sender.port;
  };
  if (static_cast<std::size_t>(std::count_if(unfinished_.begin(), unfinished_.end(), is_senders)) >=
      limits_.max_messages_per_sender)
    drop(std::find_if(unfinished_.begin(), unfinished_.end(), is_senders), "message_displaced");
  if (unfinished_.size() >= limits_.max_messages) drop(unfinished_.begin(), "message_displaced");
  Unfinished message;
  message.key = fragment.key;
  message.message_bytes = fragment.message_bytes;
  message.fragments = fragment.fragments;
  message.arrival = arrival;
  return unfinished_.insert(unfinished_.end(), std::move(message));
}

std::optional<WireMessage> Reassembly::finish_if_whole(Messages::iterator message) {
  // Fragments 1 and up may have arrived before number 0, whose channel shows that they are not wanted.
  const bool unwanted = !message->channel.empty() && !is_subscribed(message->channel);
  if (unwanted) {
    close(message->key, false);
    drop(message);
    return std::nullopt;
  }
  if (message->payload.size() < message->message_bytes) return std::nullopt;
  close(message->key, true);
  // All bytes are there, so as many fragments as were announced must be: otherwise two had one number, or one was
  // wrong.
  if (message->received != message->fragments) {
    drop(message, "fragment_mismatch");
    return std::nullopt;
  }
  WireMessage whole{std::move(message->channel),
                    std::make_shared<const std::vector<std::uint8_t>>(std::move(message->payload)), message->arrival};
  drop(message);
  return whole;
}

bool Reassembly::make_room(const Unfinished& message, std::size_t bytes) {
  for (auto oldest = unfinished_.begin();
       held_bytes_ + bytes > limits_.max_held_bytes && oldest != unfinished_.end();) {
    const auto candidate = oldest++;
    if (&*candidate != &message) drop(candidate, "message_displaced");
  }
  return held_bytes_ + bytes <= limits_.max_held_bytes;
}

void Reassembly::expire(MonotonicTime now) {
  for (auto message = unfinished_.begin(); message != unfinished_.end();) {
    const auto candidate = message++;
    if (now.us - candidate->arrival.us > limits_.patience_us) drop(candidate, "message_incomplete");
  }
}

void Reassembly::drop(Messages::iterator message, std::string_view kind) {
  if (!kind.empty()) {
    count_(kind, 1);
    close(message->key, true);
  }
  held_bytes_ -= message->held_bytes;
  unfinished_.erase(message);
}

Reassembly::Closed* Reassembly::closed(const Key& key) {
  const auto found =
      std::find_if(closed_.begin(), closed_.end(), [&](const Closed& entry) { return entry.used && entry.key == key; });
  return found == closed_.end() ? nullptr : &*found;
}

void Reassembly::close(const Key& key, bool wanted) {
  if (Closed* const known = closed(key)) {
    known->wanted = wanted;
    return;
  }
  closed_[next_closed_] = {key, true, wanted};
  next_closed_ = (next_closed_ + 1) % closed_.size();
}

}  // namespace pilotfish::bus
