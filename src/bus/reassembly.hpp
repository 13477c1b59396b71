#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "incoming.hpp"

namespace pilotfish::bus {

/// Who sent a datagram.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
};

struct ReassemblyLimits {
  std::size_t max_message_bytes = 32 << 20;
  std::size_t max_held_bytes = 64 << 20;  ///< received bytes of all unfinished messages together
  std::size_t max_messages = 32;          ///< unfinished at a time
  std::size_t max_messages_per_sender = 4;
  std::int64_t patience_us = 1'000'000;  ///< from a message's first fragment to its last
};

/// LCM's datagrams in, whole messages out. No socket, no clock, and no field of a datagram is used unchecked:
/// in liblcm 1.3.1 a fragment's offset lets 64 bytes be written anywhere. Big endian:
///
///   short:     "LC02", u32 sequence number, channel with a final zero, payload
///   fragment:  "LC03", u32 sequence number, u32 payload bytes of the message, u32 offset of this part,
///              u16 number of this fragment, u16 fragments; number 0 goes on with the channel and its zero; the part
///
/// Fragments of a message share sender and sequence number. They may come in any order. A message's memory grows with
/// the bytes received, not with those announced. A byte once received is never overwritten: a repeated fragment
/// is ignored if it is the same, else the message is dropped.
class Reassembly {
 public:
  explicit Reassembly(Count count, const ReassemblyLimits& limits = {});

  /// Messages of other channels are dropped at their fragment 0, and the fragments behind it unread.
  void subscribe(const std::string& channel) { subscribed_.insert(channel); }

  /// The message that this datagram completes, if it does. Counts datagram_not_lcm, datagram_channel_bad,
  /// fragment_header_bad, fragment_out_of_bounds, fragment_mismatch (contradicts the fragments before it),
  /// fragment_repeated, fragment_overlap, fragment_late (its message is complete or dropped), message_too_large,
  /// message_incomplete (timeout), message_displaced (a newer one needed its place).
  std::optional<WireMessage> take(const std::uint8_t* datagram, std::size_t size_bytes, Sender sender,
                                  MonotonicTime arrival);

  std::size_t held_bytes() const { return held_bytes_; }
  std::size_t unfinished() const { return unfinished_.size(); }

 private:
  struct Key {
    Sender sender;
    std::uint32_t sequence = 0;
    bool operator==(const Key& other) const;
  };
  struct Fragment;
  struct Unfinished {
    Key key;
    std::uint32_t message_bytes = 0, received = 0;
    std::uint16_t fragments = 0;
    std::string channel;                                       ///< empty until fragment 0 has come
    std::vector<std::uint8_t> payload;                         ///< from its beginning up to the first gap
    std::map<std::uint32_t, std::vector<std::uint8_t>> ahead;  ///< parts behind a gap, by offset
    MonotonicTime arrival;
    std::size_t held_bytes = 0;
  };
  struct Closed {
    Key key;
    bool used = false, wanted = false;  ///< wanted: on a channel subscribed to
  };
  using Messages = std::list<Unfinished>;

  std::optional<WireMessage> take_short(const std::uint8_t* rest, std::size_t size_bytes, MonotonicTime arrival);
  std::optional<WireMessage> take_fragment(const Fragment& fragment, MonotonicTime arrival);
  /// Puts it into its place; the name of what is wrong with it, else.
  std::string_view add(Unfinished& message, const Fragment& fragment);
  std::string_view compare(const Unfinished& message, const Fragment& fragment) const;
  bool may_begin(const Fragment& fragment);
  Messages::iterator begin(const Fragment& fragment, MonotonicTime arrival);
  std::optional<WireMessage> finish_if_whole(Messages::iterator message);
  bool make_room(const Unfinished& message, std::size_t bytes);
  void expire(MonotonicTime now);
  /// With a kind, it is counted, and further fragments of the message are ignored.
  void drop(Messages::iterator message, std::string_view kind = {});
  void close(const Key& key, bool wanted);
  Closed* closed(const Key& key);
  bool is_subscribed(std::string_view channel) const { return subscribed_.find(channel) != subscribed_.end(); }

  Count count_;
  ReassemblyLimits limits_;
  std::set<std::string, std::less<>> subscribed_;
  Messages unfinished_;              ///< oldest first
  std::array<Closed, 64> closed_{};  ///< a ring: messages whose further fragments are ignored
  std::size_t next_closed_ = 0;
  std::size_t held_bytes_ = 0;
};

}  // namespace pilotfish::bus
