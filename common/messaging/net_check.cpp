// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/net_check.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <sstream>

namespace rf {
namespace {

constexpr const char* kRaise =
    "sudo sysctl -w net.core.rmem_max=8388608 net.core.rmem_default=2097152";

class Socket {
 public:
  Socket() : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {}
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

long readNumber(const char* path) {
  std::ifstream file(path);
  long value = 0;
  file >> value;
  return file ? value : 0;
}

/// A datagram socket can be connected exactly when there is a route.
bool hasMulticastRoute() {
  const Socket s;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  address.sin_addr.s_addr = inet_addr("239.255.76.67");
  return connect(s.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

bool isLoopbackUp() {
  const Socket s;
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  return ioctl(s.fd(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

void addProblems(NetworkReport& report) {
  if (!report.loopback_up) {
    report.problems.push_back({"the loopback interface is down", "sudo ip link set lo up", true});
  }
  if (!report.multicast_route) {
    report.problems.push_back(
        {"there is no route for multicast packets",
         "sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo", true});
  }
  if (report.granted_buffer < report.asked) {
    report.problems.push_back({fmt::format("sockets get a receive buffer of {} bytes where {} are "
                                           "asked for; messages above about {} "
                                           "KB are lost",
                                           report.granted_buffer, report.asked,
                                           largestMessage(report.granted_buffer) / 1000),
                               kRaise, false});
  }
}

}  // namespace

bool NetworkReport::usable() const {
  for (const auto& problem : problems) {
    if (problem.fatal) return false;
  }
  return true;
}

std::string NetworkReport::text() const {
  std::string out;
  for (const auto& p : problems) {
    out +=
        fmt::format("{}: {}; mend it with: {}\n", p.fatal ? "error" : "warning", p.what, p.command);
  }
  return out;
}

long grantedReceiveBuffer(long asked) {
  const Socket s;
  const int want = static_cast<int>(asked);
  int got = 0;
  socklen_t size = sizeof got;
  setsockopt(s.fd(), SOL_SOCKET, SO_RCVBUF, &want, sizeof want);
  if (getsockopt(s.fd(), SOL_SOCKET, SO_RCVBUF, &got, &size) != 0) return 0;
  return got / 2;
}

std::size_t largestMessage(long granted_buffer) { return static_cast<std::size_t>(granted_buffer); }

std::string tooLargeText(const std::string& channel, std::size_t bytes, long asked, long granted) {
  return fmt::format(
      "{}: a message of {} bytes is larger than what the receive buffer holds ({} bytes; the "
      "kernel granted {} "
      "of {} asked for, capped by net.core.rmem_max); not sent. Raise it: {}",
      channel, bytes, largestMessage(granted), granted, asked, kRaise);
}

long kernelReceiveBufferErrors() {
  std::ifstream file("/proc/net/snmp");
  std::string names;
  std::string values;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("Udp:", 0) != 0) continue;
    (names.empty() ? names : values) = line;
    if (!values.empty()) break;
  }
  std::istringstream name_stream(names);
  std::istringstream value_stream(values);
  std::string name;
  std::string value;
  while (name_stream >> name && value_stream >> value) {
    if (name == "RcvbufErrors") return std::strtol(value.c_str(), nullptr, 10);
  }
  return 0;
}

NetworkReport checkNetwork(long asked_buffer) {
  NetworkReport report;
  report.asked = asked_buffer;
  report.multicast_route = hasMulticastRoute();
  report.loopback_up = isLoopbackUp();
  report.rmem_max = readNumber("/proc/sys/net/core/rmem_max");
  report.granted_buffer = grantedReceiveBuffer(asked_buffer);
  addProblems(report);
  return report;
}

}  // namespace rf
