#include "udpm_receiver.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {
namespace {

constexpr std::size_t kMaxDatagram = 65536;
/// How often this host's addresses are read again: reading them costs more than a datagram.
constexpr std::int64_t kAddressesGoodForUs = 1'000'000;

/// For the kernel: no datagram that begins with "LC03". The loads are relative to the UDP header of 8 bytes; a load
/// behind the end drops the datagram too.
void refuse_fragments_in_the_kernel(int descriptor) {
  constexpr std::uint32_t kFragmented = 0x4c433033, kAll = 0xFFFFFFFF;
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, 8),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kFragmented, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0),
      BPF_STMT(BPF_RET | BPF_K, kAll),
  };
  const sock_fprog filter{sizeof program / sizeof *program, program};
  ::setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter);  // refused: it only costs more
}

/// 0.0.0.0 too: a host whose only route is that of loopback sends from there. The kernel accepts it from no other host.
std::vector<std::uint32_t> addresses_of_this_host() {
  std::vector<std::uint32_t> addresses{INADDR_ANY};
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return addresses;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next)
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) {
      sockaddr_in address{};
      std::memcpy(&address, entry->ifa_addr, sizeof address);
      addresses.push_back(ntohl(address.sin_addr.s_addr));
    }
  ::freeifaddrs(list);
  return addresses;
}

template <class Value>
bool read_control(const cmsghdr& header, int type, Value& value) {
  if (header.cmsg_level != SOL_SOCKET || header.cmsg_type != type || header.cmsg_len < CMSG_LEN(sizeof value))
    return false;
  std::memcpy(&value, CMSG_DATA(&header), sizeof value);
  return true;
}

std::uint32_t drops_until_now(int descriptor) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> numbers{};
  socklen_t size = sizeof numbers;
  ::getsockopt(descriptor, SOL_SOCKET, SO_MEMINFO, numbers.data(), &size);
  return numbers[SK_MEMINFO_DROPS];
}

/// The kernel's information on a datagram beside its bytes.
struct Received {
  ssize_t size_bytes = -1;
  sockaddr_in sender{};
  std::optional<std::int64_t> stamp_wall_us;
  std::optional<std::uint32_t> drops;  ///< of this socket, since it was opened

  Received(int descriptor, std::vector<std::uint8_t>& datagram) {
    alignas(cmsghdr) char control[128];
    iovec vector{datagram.data(), datagram.size()};
    msghdr message{};
    message.msg_name = &sender;
    message.msg_namelen = sizeof sender;
    message.msg_iov = &vector;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    do size_bytes = ::recvmsg(descriptor, &message, MSG_DONTWAIT);
    while (size_bytes < 0 && errno == EINTR);
    if (size_bytes < 0) return;
    for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
      timespec stamp{};
      std::uint32_t count = 0;
      if (read_control(*header, SCM_TIMESTAMPNS, stamp))
        stamp_wall_us = std::int64_t{stamp.tv_sec} * 1'000'000 + stamp.tv_nsec / 1'000;
      else if (read_control(*header, SO_RXQ_OVFL, count))
        drops = count;
    }
  }
};

}  // namespace

UdpmReceiver::UdpmReceiver(const MulticastUrl& url, const Count& count)
    : url_(url), count_(count), reassembly_(count), empty_(read_clocks()) {}

UdpmReceiver::~UdpmReceiver() {
  if (socket_ >= 0) ::close(socket_);
}

void UdpmReceiver::open() {
  socket_ = open_multicast_receiver(url_);
  for (const int option : {SO_TIMESTAMPNS, SO_RXQ_OVFL}) {
    const int on = 1;
    ::setsockopt(socket_, SOL_SOCKET, option, &on, sizeof on);
  }
  refuse_fragments_in_the_kernel(socket_);
  datagram_.resize(kMaxDatagram);
  empty_ = read_clocks();
}

void UdpmReceiver::subscribe(const std::string& channel, bool large) {
  if (socket_ < 0) open();
  if (large && !takes_fragments_) {
    const int unused = 0;
    ::setsockopt(socket_, SOL_SOCKET, SO_DETACH_FILTER, &unused, sizeof unused);
    takes_fragments_ = true;
    kernel_drops_ = drops_until_now(socket_);
  }
  reassembly_.subscribe(channel);
}

bool UdpmReceiver::wait(std::chrono::milliseconds timeout) {
  pollfd waiting{socket_, POLLIN, 0};
  return ::poll(&waiting, 1, static_cast<int>(timeout.count())) > 0;
}

std::optional<WireMessage> UdpmReceiver::next(Budget& budget) {
  while (!budget.used_up()) {
    const Clocks before = read_clocks();
    const Received received(socket_, datagram_);
    if (received.size_bytes < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK) count_("receive_failed", 1);
      empty_ = before;
      return std::nullopt;
    }
    const auto size_bytes = static_cast<std::size_t>(received.size_bytes);
    budget.use(size_bytes);
    // The kernel's number includes what its filter refused, and is then useless.
    if (received.drops && takes_fragments_ && *received.drops != kernel_drops_) {
      count_("receive_buffer_full", *received.drops - kernel_drops_);
      kernel_drops_ = *received.drops;
    }
    const Clocks now = read_clocks();
    const Sender sender{ntohl(received.sender.sin_addr.s_addr), ntohs(received.sender.sin_port)};
    if (url_.ttl == 0 && is_foreign(sender.address, now.monotonic)) {
      count_("datagram_foreign", 1);
      continue;
    }
    const MonotonicTime arrival = arrival_now(received.stamp_wall_us, before, now);
    if (auto message = reassembly_.take(datagram_.data(), size_bytes, sender, arrival)) return message;
  }
  return std::nullopt;
}

/// The kernel stamps a datagram when it reads it, if it did not when it came: it begins to a moment after a socket asks
/// for it. Such a stamp is later than `before`, and the datagram may be as old as the one before it.
MonotonicTime UdpmReceiver::arrival_now(std::optional<std::int64_t> stamp_wall_us, const Clocks& before,
                                        const Clocks& now) {
  if (!stamp_wall_us || *stamp_wall_us > before.wall_us) return empty_.monotonic;
  const MonotonicTime arrival = arrival_of(*stamp_wall_us, empty_, now);
  if (empty_.monotonic < arrival) empty_ = {arrival, now.wall_us - (now.monotonic.us - arrival.us)};
  return arrival;
}

bool UdpmReceiver::is_foreign(std::uint32_t address, MonotonicTime now) {
  const auto is_own = [&] {
    return std::find(own_addresses_.begin(), own_addresses_.end(), address) != own_addresses_.end();
  };
  if (is_own()) return false;
  if (!own_addresses_.empty() && now.us - own_addresses_read_.us < kAddressesGoodForUs) return true;
  own_addresses_ = addresses_of_this_host();
  own_addresses_read_ = now;
  return own_addresses_.size() > 1 && !is_own();  // 1: the kernel did not list them
}

}  // namespace pilotfish::bus
