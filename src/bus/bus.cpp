#include "pilotfish/bus/bus.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <utility>
#include <vector>

#include "image_codec.hpp"
#include "lcm_url.hpp"
#include "liblcm_incoming.hpp"
#include "multicast.hpp"
#include "pilotfish/core/robot_name.hpp"
#include "range_codec.hpp"
#include "report_codec.hpp"
#include "status_codec.hpp"
#include "udpm_receiver.hpp"

namespace pilotfish::bus {
namespace {

std::string url_or_default(const std::string& url) {
  if (!url.empty()) return url;
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  return from_environment != nullptr && *from_environment != '\0' ? from_environment : kDefaultUrl;
}

void check_channel_name(const std::string& name) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '/'; };
  if (name.empty() || name.size() > LCM_MAX_CHANNEL_NAME_LENGTH || !std::all_of(name.begin(), name.end(), allowed))
    throw ConfigError("channel", "takes 1 to 63 letters, digits, '_', '-' or '/', not '" + name + "'");
}

template <class Message>
constexpr bool has_mac =
    std::is_same_v<Message, command_t> || std::is_same_v<Message, setpoint_t> || std::is_same_v<Message, base_t>;

}  // namespace

std::string channel(const std::string& robot, const std::string& what) {
  check_robot_name(robot, "name");
  std::string name = channel_word(robot) + "_" + what;
  check_channel_name(name);
  return name;
}

// The C API on purpose: lcm-cpp.hpp of 1.3.1 hides that a subscription failed, prints decoding errors instead
// of reporting them, and lets exceptions run through liblcm's C frames.
struct Bus::Connection {
  using Decoder = std::function<void(const WireMessage&)>;
  struct Destroy {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };

  std::string url;
  int receive_buffer_bytes = 0;
  std::optional<Key> key;
  std::function<void(const std::string&, const std::vector<std::uint8_t>&)> published;  ///< may be empty
  std::size_t turn = 0;  ///< of the counters in a state message
  std::map<std::string, std::int64_t> rejected;
  std::multimap<std::string, Decoder> decoders;  ///< by channel
  MonotonicTime arrival;                         ///< of the message being handled
  bool handling = false;
  std::unique_ptr<lcm_t, Destroy> lcm;  ///< publishes; receives what is not udpm
  std::unique_ptr<Incoming> incoming;   ///< last: it may use lcm

  void count(std::string_view kind, std::int64_t times = 1) { rejected[std::string(kind)] += times; }

  template <class Message>
  std::vector<std::uint8_t> encoded(const std::string& name, const Message& message) const {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) return {};
    if constexpr (has_mac<Message>) {
      if (key) {  // the mac is the last field
        const Mac mac = message_mac(*key, name, bytes.data(), bytes.size());
        std::copy(mac.begin(), mac.end(), bytes.end() - static_cast<std::ptrdiff_t>(mac.size()));
      }
    }
    return bytes;
  }

  template <class Message>
  void publish(const std::string& name, const Message& message, std::string_view repaired = {}) {
    if (!repaired.empty()) count(repaired);
    const std::vector<std::uint8_t> bytes = encoded(name, message);
    if (bytes.empty() || lcm_publish(lcm.get(), name.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) != 0)
      count("publish_failed");
    if (published) published(name, bytes);
  }

  template <class Value>
  using Decode = Checked<Value> (*)(const void*, std::size_t);
  template <class Value>
  using DecodeAuthentic = Checked<Value> (*)(const void*, std::size_t, const Authentication&);

  template <class Value>
  void subscribe(const std::string& name, DecodeAuthentic<Value> decode, std::function<void(Value)> handler) {
    subscribe<Value>(
        name,
        [this, name, decode](const void* data, std::size_t size_bytes) {
          return decode(data, size_bytes, {key ? &*key : nullptr, name});
        },
        std::move(handler));
  }

  template <class Value>
  void subscribe(const std::string& name, Decode<Value> decode, std::function<void(Value)> handler) {
    subscribe<Value>(name, std::function<Checked<Value>(const void*, std::size_t)>(decode), std::move(handler));
  }

  template <class Value>
  void subscribe(const std::string& name, std::function<Checked<Value>(const void*, std::size_t)> decode,
                 std::function<void(Value)> handler) {
    listen(name, false, [this, decode, handler = std::move(handler)](const WireMessage& message) {
      Checked<Value> checked = decode(message.payload->data(), message.payload->size());
      if (!checked.rejection.empty()) count(checked.rejection);
      if (checked.value) handler(std::move(*checked.value));
    });
  }

  void listen(const std::string& name, bool large, Decoder decoder) {
    incoming->subscribe(name, large);
    decoders.emplace(name, std::move(decoder));
  }

  /// All of a message's handlers are called; the first exception of theirs is thrown behind the last.
  void dispatch(const WireMessage& message) {
    arrival = message.arrival;
    std::exception_ptr failed;
    // By hand: a handler may subscribe to further channels, which leaves iterators of a multimap valid.
    for (auto decoder = decoders.lower_bound(message.channel);
         decoder != decoders.end() && decoder->first == message.channel; ++decoder) {
      try {
        decoder->second(message);
      } catch (...) {
        if (!failed) failed = std::current_exception();
      }
    }
    if (failed) std::rethrow_exception(failed);
  }

  /// Until one message of ours and all behind it are handled, a handler throws, a signal has come, the time is up,
  /// or a flood has used up what one call may take. Returns how many were handled.
  int wait_and_dispatch(std::chrono::milliseconds timeout) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point give_up = Clock::now() + timeout;
    Budget budget;
    int handled = 0;
    for (bool waiting = true; waiting && handled == 0 && !budget.used_up();) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(give_up - Clock::now());
      waiting = incoming->wait(std::max(left, std::chrono::milliseconds(0)));
      while (const auto message = incoming->next(budget)) {
        ++handled;
        dispatch(*message);
      }
    }
    return handled;
  }
};

Bus::Bus(const std::string& url) : connection_(std::make_unique<Connection>()) {
  connection_->url = url_or_default(url);
  check_lcm_url(connection_->url);
  const auto multicast = parse_multicast_url(connection_->url);
  if (multicast) connection_->receive_buffer_bytes = check_multicast(*multicast);
  connection_->lcm.reset(lcm_create(connection_->url.c_str()));
  if (!connection_->lcm)
    throw BusError("liblcm cannot open " + connection_->url +
                   "; a URL looks like udpm://239.255.76.67:7667?ttl=0 or memq://");
  // liblcm 1.3.1 can be crashed, and made to write anywhere, by two datagrams: it is never given one.
  if (multicast) {
    const Count count = [bus = connection_.get()](std::string_view kind, std::int64_t times) {
      bus->count(kind, times);
    };
    connection_->incoming = std::make_unique<UdpmReceiver>(*multicast, count);
  } else {
    const bool stamped = connection_->url.rfind("memq:", 0) == 0;
    connection_->incoming = std::make_unique<LiblcmIncoming>(connection_->lcm.get(), stamped);
  }
}

Bus::~Bus() = default;

const std::string& Bus::url() const { return connection_->url; }
int Bus::receive_buffer_bytes() const { return connection_->receive_buffer_bytes; }
const std::map<std::string, std::int64_t>& Bus::rejected() const { return connection_->rejected; }
void Bus::set_key(const Key& key) { connection_->key = key; }

void Bus::on_published(std::function<void(const std::string&, const std::vector<std::uint8_t>&)> tap) {
  connection_->published = std::move(tap);
}

void Bus::publish(const std::string& robot, const CommandReport& report) {
  std::string_view repaired;
  const command_t message = encode(report, repaired);
  connection_->publish(channel(robot, "COMMAND"), message, repaired);
}

std::unique_ptr<FinalMessage> Bus::final_message(const std::string& robot, const CommandReport& report) {
  std::string_view repaired;
  const std::string name = channel(robot, "COMMAND");
  return std::make_unique<FinalMessage>(connection_->url, name, connection_->encoded(name, encode(report, repaired)));
}

void Bus::publish(const std::string& robot, const ObservationReport& report) {
  std::string_view repaired;
  const observation_t message = encode(report, repaired);
  connection_->publish(channel(robot, "OBSERVATION"), message, repaired);
}

void Bus::publish(const std::string& robot, const StatusReport& report) {
  std::string_view repaired;
  const status_t message = encode(report, repaired, connection_->turn++);
  connection_->publish(channel(robot, "STATUS"), message, repaired);
}

void Bus::publish(const std::string& robot, const BaseReport& report) {
  std::string_view repaired;
  const base_t message = encode(report, repaired, connection_->turn++);
  connection_->publish(channel(robot, "BASE"), message, repaired);
}

void Bus::publish(const std::string& robot, const PoseReport& report) {
  std::string_view repaired;
  const bot_core::pose_t message = encode(report, repaired);
  connection_->publish(channel(robot, "POSE"), message, repaired);
}

void Bus::publish(const std::string& robot, const MotionReport& report) {
  const std::optional<motion_t> message = encode(report);
  if (!message) return connection_->count("motion_not_finite");
  connection_->publish(channel(robot, "MOTION"), *message);
}

void Bus::publish(const std::string& robot, const RangeScan& scan) {
  if (!is_usable(scan)) return connection_->count("ranges_not_publishable");
  connection_->publish(channel(robot, "RANGES"), encode(scan));
}

void Bus::publish(const std::string& robot, const SetpointReport& report) {
  check_ranges(report.setpoint, "setpoint");
  connection_->publish(channel(robot, "SETPOINT"), encode(report));
}

void Bus::publish_image(const std::string& channel, const Frame& frame) {
  check_channel_name(channel);
  if (check(frame.image) != Reason::none) return connection_->count("image_not_publishable");
  const std::size_t raw_bytes =
      static_cast<std::size_t>(frame.image.width) * static_cast<std::size_t>(frame.image.height);
  const auto message = encode_image(frame, travels_raw(raw_bytes, connection_->receive_buffer_bytes));
  if (!message) return connection_->count("image_not_publishable");
  connection_->publish(channel, *message);
}

void Bus::publish_preview(const std::string& robot, const Frame& frame, int shrink, int quality) {
  if (check(frame.image) != Reason::none || shrink < 1) return connection_->count("image_not_publishable");
  const auto message = encode_preview(frame, shrink, quality);
  if (!message) return connection_->count("image_not_publishable");
  connection_->publish(channel(robot, "PREVIEW"), *message);
}

void Bus::on_image(const std::string& channel, std::function<void(Frame)> handler) {
  check_channel_name(channel);
  connection_->listen(channel, true,
                      [bus = connection_.get(), handler = std::move(handler)](const WireMessage& message) {
                        Checked<Frame> checked = decode_image(message.payload);
                        if (!checked.value) return bus->count(checked.rejection);
                        handler(std::move(*checked.value));
                      });
}

void Bus::on_encoded_image(const std::string& channel, std::function<void(EncodedImage)> handler) {
  check_channel_name(channel);
  connection_->listen(channel, true,
                      [bus = connection_.get(), handler = std::move(handler)](const WireMessage& message) {
                        const auto header = read_image_header(message.payload->data(), message.payload->size());
                        if (!header.value) return bus->count(header.rejection);
                        const bool is_jpeg = header.value->pixelformat == bot_core::image_t::PIXEL_FORMAT_MJPEG;
                        handler({header.value->utime, header.value->width, header.value->height, is_jpeg,
                                 message.arrival, message.payload});
                      });
}

void Bus::on_setpoint(const std::string& robot, std::function<void(SetpointReport)> handler) {
  connection_->subscribe<SetpointReport>(channel(robot, "SETPOINT"), &decode_setpoint, std::move(handler));
}

void Bus::on_command(const std::string& robot, std::function<void(CommandReport)> handler) {
  connection_->subscribe<CommandReport>(channel(robot, "COMMAND"), &decode_command, std::move(handler));
}

void Bus::on_status(const std::string& robot, std::function<void(StatusReport)> handler) {
  connection_->subscribe<StatusReport>(channel(robot, "STATUS"), &decode_status, std::move(handler));
}

void Bus::on_base(const std::string& robot, std::function<void(BaseReport)> handler) {
  connection_->subscribe<BaseReport>(channel(robot, "BASE"), &decode_base, std::move(handler));
}

void Bus::on_pose(const std::string& robot, std::function<void(MotionReport)> handler) {
  connection_->subscribe<MotionReport>(channel(robot, "POSE"), &decode_pose, std::move(handler));
}

void Bus::on_motion(const std::string& robot, std::function<void(MotionReport)> handler) {
  connection_->subscribe<MotionReport>(channel(robot, "MOTION"), &decode_motion, std::move(handler));
}

void Bus::on_ranges(const std::string& robot, std::function<void(RangeScan)> handler) {
  connection_->subscribe<RangeScan>(channel(robot, "RANGES"), &decode_ranges, std::move(handler));
}

MonotonicTime Bus::arrival() const { return connection_->arrival; }

int Bus::handle(int timeout_ms) {
  Connection& bus = *connection_;
  if (bus.handling) throw std::logic_error("Bus::handle called from one of its own handlers: it is not re-entrant");
  struct Handling {
    bool& flag;
    explicit Handling(bool& on) : flag(on) { flag = true; }
    ~Handling() { flag = false; }
  } const handling(bus.handling);
  return bus.wait_and_dispatch(std::chrono::milliseconds(std::max(timeout_ms, 0)));
}

}  // namespace pilotfish::bus
