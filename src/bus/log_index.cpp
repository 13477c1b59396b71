#include "log_index.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::string_view kSyncBytes = "\xED\xA1\xDA\x01";
constexpr std::int64_t kHeaderBytes = 4 + 8 + 8 + 4 + 4;
/// A file without a message in so many bytes is no log, and may be as large as a disk.
constexpr std::int64_t kFirstMessageWithin_bytes = 64 << 20;

struct Header {
  std::string channel;
  LogIndex::Event event;
  std::int64_t end = 0;  ///< where the next event begins
};

std::optional<Header> read_header(std::istream& file, std::int64_t offset, std::int64_t file_bytes) {
  constexpr std::int32_t kMaxChannelLetters = 63;
  std::array<char, kHeaderBytes> bytes{};
  file.clear();
  if (!file.seekg(offset) || !file.read(bytes.data(), bytes.size())) return std::nullopt;
  WireReader reader(bytes.data(), bytes.size());
  std::uint32_t sync_word = 0;
  std::int32_t channel_letters = 0, data_bytes = 0;
  reader.read(sync_word);
  reader.skip(8 + 8);
  reader.read(channel_letters);
  reader.read(data_bytes);
  if (sync_word != kSyncWord || channel_letters < 1 || channel_letters > kMaxChannelLetters || data_bytes < 0)
    return std::nullopt;

  Header header;
  header.event = {offset + kHeaderBytes + channel_letters, data_bytes};
  header.end = header.event.data_offset + data_bytes;
  header.channel.resize(static_cast<std::size_t>(channel_letters));
  if (header.end > file_bytes || !file.read(header.channel.data(), channel_letters)) return std::nullopt;
  return header;
}

/// The first sync word at or after `offset`; the end of the file if there is none.
std::int64_t find_sync(std::istream& file, std::int64_t offset, std::int64_t file_bytes) {
  // Small at first: in a file that is damaged every few bytes, long reads would take a time that grows with its square.
  constexpr std::size_t kFirstChunk = 256, kLastChunk = 1 << 16, kOverlap = 3;  // a sync word may straddle two
  std::string chunk(kFirstChunk, '\0');
  while (offset + static_cast<std::int64_t>(kSyncBytes.size()) <= file_bytes) {
    file.clear();
    file.seekg(offset);
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const auto read = static_cast<std::size_t>(file.gcount());
    const std::size_t found = std::string_view(chunk.data(), read).find(kSyncBytes);
    if (found != std::string_view::npos) return offset + static_cast<std::int64_t>(found);
    if (read <= kOverlap) break;
    offset += static_cast<std::int64_t>(read - kOverlap);
    chunk.resize(std::min(2 * chunk.size(), kLastChunk));
  }
  return file_bytes;
}

}  // namespace

LogIndex index_log(std::istream& file, const std::string& channel) {
  LogIndex index;
  file.clear();
  file.seekg(0, std::ios::end);
  const std::int64_t file_bytes = file.tellg();
  const auto search_until = [&] {
    return index.channels.empty() ? std::min(file_bytes, kFirstMessageWithin_bytes) : file_bytes;
  };
  for (std::int64_t offset = 0; offset < search_until();) {
    if (const auto header = read_header(file, offset, file_bytes)) {
      ++index.channels[header->channel];
      if (header->channel == channel) index.events.push_back(header->event);
      offset = header->end;
    } else {
      ++index.damaged;
      offset = find_sync(file, offset + 1, search_until());
    }
  }
  return index;
}

}  // namespace pilotfish::bus
