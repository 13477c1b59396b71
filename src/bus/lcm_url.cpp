#include "lcm_url.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>

#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {
namespace {

constexpr std::array<std::string_view, 5> kProviders = {"udpm", "mpudpm", "memq", "tcpq", "file"};
constexpr int kPatience_ms = 1000;

/// The error of a connection that has been asked for without waiting; 0: there it is.
int outcome(int descriptor) {
  pollfd waiting{descriptor, POLLOUT, 0};
  if (::poll(&waiting, 1, kPatience_ms) <= 0) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

/// Why no receiver can be reached there; nullptr: one can.
const char* unreachable(const std::string& host, const std::string& port) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;  // as liblcm
  wanted.ai_socktype = SOCK_STREAM;
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found)) return ::gai_strerror(error);
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, ::freeaddrinfo);
  int error = EADDRNOTAVAIL;
  for (const addrinfo* address = found; address != nullptr && error != 0; address = address->ai_next) {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0) return std::strerror(errno);
    error = ::connect(descriptor, address->ai_addr, address->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS) error = outcome(descriptor);
    ::close(descriptor);
  }
  return error == 0 ? nullptr : std::strerror(error);
}

/// host:port, of which liblcm completes what is missing to localhost:7700.
void check_server(const std::string& url, std::string_view network) {
  const std::size_t colon = network.find(':');
  std::string host(network.substr(0, colon));
  std::string port(colon == std::string_view::npos ? std::string_view() : network.substr(colon + 1));
  if (host.empty()) host = "localhost";
  if (port.empty()) port = "7700";
  if (const char* problem = unreachable(host, port))
    throw BusError("no LCM server answers at " + host + ":" + port + ", which " + url + " names: " + problem +
                   ". Start one there (java -cp lcm.jar lcm.lcm.TCPService " + port +
                   "), or use udpm://239.255.76.67:7667?ttl=0, which needs none");
}

}  // namespace

void check_lcm_url(const std::string& url) {
  constexpr std::string_view kAfterScheme = "://";
  const std::size_t end = url.find(kAfterScheme);
  const std::string scheme = url.substr(0, end);
  if (end == std::string::npos || std::find(kProviders.begin(), kProviders.end(), scheme) == kProviders.end()) {
    std::string known;
    for (const std::string_view provider : kProviders) known += (known.empty() ? "" : ", ") + std::string(provider);
    throw BusError("the LCM URL " + url + " does not begin with a provider of liblcm, as in " +
                   "udpm://239.255.76.67:7667?ttl=0 or memq://; known: " + known);
  }
  if (scheme != "tcpq") return;
  const std::string_view rest = std::string_view(url).substr(end + kAfterScheme.size());
  check_server(url, rest.substr(0, rest.find('?')));
}

}  // namespace pilotfish::bus
