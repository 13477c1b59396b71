#include "pilotfish/bus/bus.hpp"

#include <lcm/lcm.h>
#include <poll.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <utility>
#include <vector>

#include "image_codec.hpp"
#include "multicast.hpp"
#include "report_codec.hpp"
#include "status_codec.hpp"

namespace pilotfish::bus {
namespace {

/// More than any honest sender puts into the queues between two calls; a flood must not keep handle() for ever.
constexpr int kMaxMessagesPerCall = 1000;

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
constexpr bool has_mac = std::is_same_v<Message, command_t> || std::is_same_v<Message, setpoint_t>;

struct Destroy {
  void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
};

}  // namespace

std::string channel(const std::string& robot, const std::string& what) {
  check_channel_name(robot);
  std::string name = robot;
  for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  name += "_" + what;
  check_channel_name(name);
  return name;
}

// The C API on purpose: lcm-cpp.hpp of 1.3.1 hides that a subscription failed, prints decoding errors instead
// of reporting them, and lets exceptions run through liblcm's C frames.
struct Bus::Connection {
  struct Subscription {
    Connection* connection;
    std::function<void(const void* data, std::size_t size_bytes)> decode_and_hand_over;
  };

  std::string url;
  int receive_buffer_bytes = 0;
  std::optional<Key> key;
  std::size_t turn = 0;  ///< of the counters in a state message
  std::map<std::string, std::int64_t> rejected;
  std::vector<std::unique_ptr<Subscription>> subscriptions;
  std::exception_ptr handler_failed;
  bool handling = false;
  int handled = 0;                      ///< in this call of handle()
  std::unique_ptr<lcm_t, Destroy> lcm;  // last: its thread ends before anything above goes

  void count(std::string_view kind) { ++rejected[std::string(kind)]; }

  template <class Message>
  void publish(const std::string& name, const Message& message, std::string_view repaired = {}) {
    if (!repaired.empty()) count(repaired);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    const int size_bytes = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    if constexpr (has_mac<Message>) {
      if (key) {  // the mac is the last field
        const Mac mac = message_mac(*key, name, bytes.data(), bytes.size());
        std::copy(mac.begin(), mac.end(), bytes.end() - static_cast<std::ptrdiff_t>(mac.size()));
      }
    }
    if (size_bytes < 0 || lcm_publish(lcm.get(), name.c_str(), bytes.data(), static_cast<unsigned>(size_bytes)) != 0)
      count("publish_failed");
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
    auto subscription = std::make_unique<Subscription>();
    subscription->connection = this;
    subscription->decode_and_hand_over = [this, decode, handler = std::move(handler)](const void* data,
                                                                                      std::size_t size_bytes) {
      Checked<Value> checked = decode(data, size_bytes);
      if (!checked.rejection.empty()) count(checked.rejection);
      if (checked.value) handler(std::move(*checked.value));
    };
    if (lcm_subscribe(lcm.get(), name.c_str(), &Connection::received, subscription.get()) == nullptr)
      throw BusError("liblcm could not subscribe to " + name + " on " + url);
    subscriptions.push_back(std::move(subscription));
  }

  /// Until one message of ours and all behind it are handled, a handler has thrown, a signal has come or the
  /// time is up.
  void wait_and_dispatch(std::chrono::milliseconds patience) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point give_up = Clock::now() + patience;
    // Without a subscription liblcm has no receiver to wait on; a descriptor of -1 makes poll() wait all the same.
    pollfd waiting{subscriptions.empty() ? -1 : lcm_get_fileno(lcm.get()), POLLIN, 0};
    do {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(give_up - Clock::now());
      if (::poll(&waiting, 1, std::max(static_cast<int>(left.count()), 0)) <= 0) return;
      // What liblcm calls handled need not be ours: on a busy machine one of its own self-test messages may
      // be left over.
      int dispatched = 0;
      while (dispatched < kMaxMessagesPerCall && !handler_failed && lcm_handle_timeout(lcm.get(), 0) > 0) ++dispatched;
      if (dispatched == 0) waiting.fd = -1;  // liblcm can give no more, as at the end of a log: let the time pass
    } while (handled == 0);
  }

  /// Called from liblcm's C code, which an exception must not cross: the first one is kept for handle() to throw.
  static void received(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* context) noexcept {
    auto* subscription = static_cast<Subscription*>(context);
    ++subscription->connection->handled;
    try {
      subscription->decode_and_hand_over(buffer->data, buffer->data_size);
    } catch (...) {
      if (!subscription->connection->handler_failed)
        subscription->connection->handler_failed = std::current_exception();
    }
  }
};

Bus::Bus(const std::string& url) : connection_(std::make_unique<Connection>()) {
  connection_->url = url_or_default(url);
  if (const auto multicast = parse_multicast_url(connection_->url))
    connection_->receive_buffer_bytes = check_multicast(*multicast);
  connection_->lcm.reset(lcm_create(connection_->url.c_str()));
  if (!connection_->lcm)
    throw BusError("liblcm cannot open " + connection_->url +
                   "; a URL looks like udpm://239.255.76.67:7667?ttl=0 or memq://");
}

Bus::~Bus() = default;

const std::string& Bus::url() const { return connection_->url; }
int Bus::receive_buffer_bytes() const { return connection_->receive_buffer_bytes; }
const std::map<std::string, std::int64_t>& Bus::rejected() const { return connection_->rejected; }
void Bus::set_key(const Key& key) { connection_->key = key; }

void Bus::publish(const std::string& robot, const CommandReport& report) {
  std::string_view repaired;
  const command_t message = encode(report, repaired);
  connection_->publish(channel(robot, "COMMAND"), message, repaired);
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

void Bus::on_image(const std::string& channel, std::function<void(Frame)> handler) {
  check_channel_name(channel);
  connection_->subscribe<Frame>(channel, &decode_image, std::move(handler));
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

int Bus::handle(int timeout_ms) {
  Connection& bus = *connection_;
  if (bus.handling) throw std::logic_error("Bus::handle called from one of its own handlers: liblcm is not re-entrant");
  bus.handling = true;
  bus.handled = 0;
  bus.wait_and_dispatch(std::chrono::milliseconds(std::max(timeout_ms, 0)));
  bus.handling = false;
  if (bus.handler_failed) std::rethrow_exception(std::exchange(bus.handler_failed, nullptr));
  return bus.handled;
}

}  // namespace pilotfish::bus
