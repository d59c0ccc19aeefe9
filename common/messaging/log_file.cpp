// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/log_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace rf {
namespace {

// Per event, big-endian: u32 sync, i64 number, i64 utime, i32 channel bytes, i32 data bytes, then
// both.
constexpr std::array<std::uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::int64_t kHeaderBytes = 28;

std::int64_t bigEndian(const std::uint8_t* bytes, int n) {
  std::uint64_t value = 0;
  for (int i = 0; i < n; ++i) value = value << 8U | bytes[i];
  return n == 4 ? static_cast<std::int32_t>(value) : static_cast<std::int64_t>(value);
}

void append(std::vector<std::uint8_t>& out, std::int64_t value, int n) {
  for (int i = n - 1; i >= 0; --i) {
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
}

}  // namespace

LogReader::LogReader(const std::string& path) : file_(path, std::ios::binary | std::ios::ate) {
  if (!file_ || file_.tellg() < 0)
    throw std::runtime_error(path + ": cannot be opened as an LCM log");
  size_ = file_.tellg();
}

bool LogReader::read(std::int64_t at, void* out, std::size_t bytes) {
  if (at < 0 || at + static_cast<std::int64_t>(bytes) > size_) return false;
  file_.clear();
  file_.seekg(at);
  file_.read(static_cast<char*>(out), static_cast<std::streamsize>(bytes));
  return static_cast<std::size_t>(file_.gcount()) == bytes;
}

std::optional<LogReader::Header> LogReader::headerAt(std::int64_t at) {
  std::array<std::uint8_t, kHeaderBytes> raw{};
  if (!read(at, raw.data(), raw.size()) || !std::equal(kSync.begin(), kSync.end(), raw.begin())) {
    return std::nullopt;
  }
  const Header header{bigEndian(&raw[4], 8), bigEndian(&raw[12], 8), bigEndian(&raw[20], 4),
                      bigEndian(&raw[24], 4)};
  if (header.channel_bytes < 1 ||
      header.channel_bytes > static_cast<std::int64_t>(kMaxChannelName) || header.data_bytes < 0 ||
      header.data_bytes > static_cast<std::int64_t>(kMaxEventBytes)) {
    return std::nullopt;
  }
  return header;
}

std::optional<std::int64_t> LogReader::findHeader(std::int64_t from, std::int64_t to) {
  std::vector<std::uint8_t> block(1U << 16U);
  for (std::int64_t at = from; at + 4 <= to;) {
    const auto n = static_cast<std::size_t>(
        std::min<std::int64_t>(to - at, static_cast<std::int64_t>(block.size())));
    if (!read(at, block.data(), n)) break;
    const auto end = block.begin() + static_cast<std::ptrdiff_t>(n);
    for (auto it = block.begin();; ++it) {
      it = std::search(it, end, kSync.begin(), kSync.end());
      if (it == end) break;
      const std::int64_t candidate = at + (it - block.begin());
      if (headerAt(candidate)) return candidate;
    }
    at += static_cast<std::int64_t>(n) - 3;
  }
  return std::nullopt;
}

std::optional<LogEvent> LogReader::next() {
  while (at_ < size_) {
    const auto header = headerAt(at_);
    std::int64_t resume = size_;
    if (header) {
      const std::int64_t body = at_ + kHeaderBytes;
      const std::int64_t end = body + header->channel_bytes + header->data_bytes;
      const bool fits = end <= size_;
      // An event whose end is no event's start may have a damaged length: a header inside decides.
      const bool joined = fits && (end == size_ || headerAt(end));
      const auto inside = joined ? std::nullopt : findHeader(at_ + 4, std::min(end, size_));
      if (fits && !inside) {
        LogEvent event{header->number, header->utime,
                       std::string(static_cast<std::size_t>(header->channel_bytes), 0),
                       std::vector<std::uint8_t>(static_cast<std::size_t>(header->data_bytes))};
        if (read(body, event.channel.data(), event.channel.size()) &&
            read(body + header->channel_bytes, event.data.data(), event.data.size())) {
          at_ = end;
          ++events_;
          return event;
        }
      }
      if (!inside) {
        truncated_ = true;
        at_ = size_;
        return std::nullopt;
      }
      resume = *inside;
    } else if (const auto found = findHeader(at_ + 1, size_)) {
      resume = *found;
    } else if (size_ - at_ < kHeaderBytes) {
      truncated_ = true;
      at_ = size_;
      return std::nullopt;
    }
    ++damages_;
    skipped_bytes_ += resume - at_;
    at_ = resume;
  }
  return std::nullopt;
}

LogWriter::LogWriter(const std::string& path)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc) {
  if (!file_) throw std::runtime_error(path + ": cannot be written");
}

void LogWriter::write(std::int64_t utime, const std::string& channel,
                      const std::vector<std::uint8_t>& data) {
  if (channel.empty() || channel.size() > kMaxChannelName || data.size() > kMaxEventBytes) {
    throw std::invalid_argument("log event on channel '" + channel.substr(0, 80) + "' of " +
                                std::to_string(data.size()) + " bytes exceeds the format's bounds");
  }
  std::vector<std::uint8_t> header(kSync.begin(), kSync.end());
  append(header, events_, 8);
  append(header, utime, 8);
  append(header, static_cast<std::int64_t>(channel.size()), 4);
  append(header, static_cast<std::int64_t>(data.size()), 4);
  file_.write(reinterpret_cast<const char*>(header.data()),
              static_cast<std::streamsize>(header.size()));
  file_.write(channel.data(), static_cast<std::streamsize>(channel.size()));
  file_.write(reinterpret_cast<const char*>(data.data()),
              static_cast<std::streamsize>(data.size()));
  if (!file_) throw std::runtime_error(path_ + ": cannot be written (disk full?)");
  bytes_ += kHeaderBytes + static_cast<std::int64_t>(channel.size() + data.size());
  ++events_;
}

void LogWriter::flush() {
  file_.flush();
  if (!file_) throw std::runtime_error(path_ + ": cannot be written (disk full?)");
}

}  // namespace rf
