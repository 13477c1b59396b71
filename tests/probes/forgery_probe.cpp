// forgery_probe SEED COUNT   COUNT messages of a sender that receives everything on the bus but has no key, half of
// them
//                            commands, half setpoints, through the decoders of the bus and the guards behind them
//
// Prints one "key value" a line: how many of each kind of forgery there were, how many were accepted, and what became
// of the genuine messages in between (so that "0 accepted" is not the answer of a receiver that refuses everything).
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "encoding.hpp"
#include "pilotfish/core/session_guard.hpp"
#include "random_numbers.hpp"
#include "report_codec.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::bus;
using probes::RandomNumbers;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kSession = 0x123456789ABCDEF, kOtherSession = 0x0FEDCBA98765432;
constexpr const char* kForgeries[] = {"mac_random",    "mac_zero",  "bits_flipped", "replayed", "other_channel",
                                      "other_session", "other_key", "spliced",      "shifted",  "mac_of_prefix"};
constexpr int kKinds = std::size(kForgeries);
constexpr int kGenuineEvery = 1000, kRecorded = 64;

Key key_of(std::uint8_t fill) {
  std::array<std::uint8_t, Key::kBytes> bytes{};
  bytes.fill(fill);
  return Key(bytes);
}

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

void put_mac(Bytes& message, const Mac& mac) { std::copy(mac.begin(), mac.end(), message.end() - mac.size()); }
Bytes signed_with(const Key& key, const std::string& channel, Bytes message) {
  put_mac(message, message_mac(key, channel, message.data(), message.size()));
  return message;
}

/// A command or a setpoint that would be accepted, but for its mac.
Bytes command_bytes(std::int64_t session, std::int64_t counter, RandomNumbers& random) {
  CommandReport report;
  report.utime = counter;
  report.session = session;
  report.counter = counter;
  report.command = {random.between(-0.6, 0.6), random.between(-2.0, 2.0)};
  report.status = Status::tracking;
  std::string_view repaired;
  return encoded(encode(report, repaired));
}
Bytes setpoint_bytes(std::int64_t session, std::int64_t counter, RandomNumbers& random) {
  return encoded(
      encode(SetpointReport{counter, session, counter, {random.between(0.5, 3.0), random.between(-1.0, 1.0), true}}));
}

/// The coordinator's or the base's side: what it accepts is all that moves the robot.
class Receiver {
 public:
  Receiver(bool setpoints, std::string channel)
      : setpoints_(setpoints), channel_(std::move(channel)), guard_(kSession), gate_(kSession, 0.4) {}

  bool accepts(const Key& key, const Bytes& message) {
    const Authentication authentication{&key, channel_};
    if (setpoints_) {
      const auto checked = decode_setpoint(message.data(), message.size(), authentication);
      if (!checked.value) return false;
      const auto& asked = *checked.value;
      const SetpointDecision decision = gate_.decide(asked.session, asked.counter, asked.setpoint, kept_);
      const bool target_moved =
          decision.setpoint.distance_m != kept_.distance_m || decision.setpoint.bearing_rad != kept_.bearing_rad;
      stops_ += decision.verdict == SetpointVerdict::stopped ? 1 : 0;
      kept_ = decision.setpoint;
      return decision.verdict == SetpointVerdict::accepted || target_moved;
    }
    const auto checked = decode_command(message.data(), message.size(), authentication);
    return checked.value && guard_.accept(checked.value->session, checked.value->counter) == SequenceVerdict::accepted;
  }
  int stops() const { return stops_; }
  const std::string& channel() const { return channel_; }
  Bytes fresh(std::int64_t session, std::int64_t counter, RandomNumbers& random) const {
    return setpoints_ ? setpoint_bytes(session, counter, random) : command_bytes(session, counter, random);
  }

 private:
  bool setpoints_;
  std::string channel_;
  SequenceGuard guard_;
  SetpointGate gate_;
  Setpoint kept_;
  int stops_ = 0;
};

/// `recorded` are genuine messages that have been delivered; `counter` is higher than any of them.
Bytes forge(int kind, const Receiver& receiver, const Key& key, const Key& other_key,
            const std::vector<Bytes>& recorded, std::int64_t counter, RandomNumbers& random) {
  const auto any = [&]() -> const Bytes& { return recorded[random.below(static_cast<int>(recorded.size()))]; };
  Bytes fresh = receiver.fresh(kSession, counter, random);
  switch (kind) {
    case 0: {
      Mac mac{};
      for (std::uint8_t& byte : mac) byte = static_cast<std::uint8_t>(random.bits());
      put_mac(fresh, mac);
      return fresh;
    }
    case 1: return fresh;
    case 2: {
      Bytes message = any();
      for (int flips = 1 + random.below(4); flips > 0; --flips)
        message[random.below(static_cast<int>(message.size()))] ^= static_cast<std::uint8_t>(1 << random.below(8));
      return message;
    }
    case 3: return any();
    case 4: return signed_with(key, "OTHER_" + receiver.channel(), fresh);
    case 5: return signed_with(key, receiver.channel(), receiver.fresh(kOtherSession, counter, random));
    case 6: return signed_with(other_key, receiver.channel(), fresh);
    case 7: {
      const Bytes& donor = any();
      std::copy(donor.end() - sizeof(Mac), donor.end(), fresh.end() - sizeof(Mac));
      return fresh;
    }
    case 8: {  // a letter moved from the channel's name into the message would have the same text before the mac
      Bytes message = any();
      message.insert(message.begin(), static_cast<std::uint8_t>(receiver.channel().back()));
      return message;
    }
    default: {
      Bytes message = any();
      message.resize(random.below(static_cast<int>(message.size())));
      return message;
    }
  }
}

void attack(bool setpoints, std::uint64_t seed, int count, std::map<std::string, int>& counts) {
  RandomNumbers random(seed);
  const Key key = key_of(0x5A), other_key = key_of(0x5B);
  Receiver receiver(setpoints, setpoints ? "ROBOT1_SETPOINT" : "ROBOT1_COMMAND");
  std::vector<Bytes> recorded;
  std::int64_t counter = 1;
  for (int i = 0; i < count; ++i) {
    if (i % kGenuineEvery == 0) {
      const Bytes genuine = signed_with(key, receiver.channel(), receiver.fresh(kSession, counter++, random));
      ++counts["genuine"];
      counts["genuine_accepted"] += receiver.accepts(key, genuine) ? 1 : 0;
      if (recorded.size() < kRecorded)
        recorded.push_back(genuine);
      else
        recorded[random.below(kRecorded)] = genuine;
    }
    const int kind = i % kKinds;
    ++counts[std::string("forged_") + kForgeries[kind]];
    const Bytes forged = forge(kind, receiver, key, other_key, recorded, counter + random.below(100), random);
    counts["forged_accepted"] += receiver.accepts(key, forged) ? 1 : 0;
  }
  counts["forged_stops_accepted"] += receiver.stops();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: forgery_probe SEED COUNT\n", stderr);
    return 2;
  }
  const std::uint64_t seed = std::stoull(argv[1]);
  const int count = std::stoi(argv[2]);
  std::map<std::string, int> counts{{"forged_accepted", 0}, {"genuine_accepted", 0}};
  attack(false, seed, count / 2, counts);
  attack(true, seed + 1, count - count / 2, counts);
  for (const auto& [key, number] : counts) std::printf("%s %d\n", key.c_str(), number);
  return 0;
}
