// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rf {

/// Receive buffer that every udpm URL asks for unless it names one, bytes.
inline constexpr long kDefaultReceiveBuffer = 2097152;

/// A thing that LCM needs and this machine lacks, with the command that mends it.
struct NetworkProblem {
  std::string what;
  std::string command;
  bool fatal = false;  ///< without it no message passes; else large messages may be lost
};

/// What this machine offers to LCM over UDP multicast.
struct NetworkReport {
  bool multicast_route = false;  ///< the kernel knows where to send multicast packets
  bool loopback_up = false;
  long rmem_max = 0;        ///< net.core.rmem_max, bytes; 0 when unreadable
  long granted_buffer = 0;  ///< receive buffer that a socket really gets when it asks for `asked`
  long asked = 0;
  std::vector<NetworkProblem> problems;

  bool usable() const;
  /// One line per problem, with its command.
  std::string text() const;
};

/// Asks the kernel; changes nothing.
NetworkReport checkNetwork(long asked_buffer = kDefaultReceiveBuffer);

/// Receive buffer in bytes that the kernel grants to a socket that asks for `asked`, as it would be
/// without the doubling that the kernel does for its own bookkeeping.
long grantedReceiveBuffer(long asked);

/// The largest message that such a buffer surely holds while its reader sleeps: as large as the
/// buffer. Measured on loopback with 60 messages of each size: granted 106496 passes 100 KB and
/// loses most of 150 KB; granted 212992 passes 250 KB and loses most of 350 KB.
std::size_t largestMessage(long granted_buffer);

/// The sentence for a message that is too large: sizes, sysctl, command.
std::string tooLargeText(const std::string& channel, std::size_t bytes, long asked, long granted);

/// UDP datagrams that this host's kernel threw away for want of room in a receive buffer, since
/// boot.
long kernelReceiveBufferErrors();

}  // namespace rf
