#include "pilotfish/bus/log_reader.hpp"

#include <filesystem>
#include <fstream>

#include "image_codec.hpp"
#include "log_index.hpp"
#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {

struct LogReader::File {
  std::ifstream stream;
  LogIndex index;
  std::size_t next = 0;
  std::int64_t last_utime = -1;
};

LogReader::LogReader(const std::string& path, const std::string& channel) : file_(std::make_unique<File>()) {
  std::error_code error;  // a pipe would block, a device never ends
  if (!std::filesystem::is_regular_file(path, error))
    throw BusError(
        "cannot read the LCM log " + path +
        (std::filesystem::is_directory(path, error) ? ": it is a folder; name a file in it" : ": no such file"));
  file_->stream.open(path, std::ios::binary);
  if (!file_->stream || file_->stream.peek() == std::ifstream::traits_type::eof())
    throw BusError("cannot read the LCM log " + path + ": it is empty, or may not be read");
  file_->index = index_log(file_->stream, channel);
  if (file_->index.channels.empty()) throw BusError(path + " is not an LCM log: there is not one whole message in it");
  if (file_->index.events.empty()) {
    std::string names;
    for (const auto& [name, count] : file_->index.channels)
      names += (names.empty() ? "" : ", ") + name + " (" + std::to_string(count) + ")";
    throw BusError("the LCM log " + path + " has no messages on channel " + channel + "; it has: " + names);
  }
}

LogReader::~LogReader() = default;

std::size_t LogReader::size() const { return file_->index.events.size(); }
std::int64_t LogReader::damaged() const { return file_->index.damaged; }

std::optional<Frame> LogReader::next() {
  if (file_->next == file_->index.events.size()) return std::nullopt;
  const LogIndex::Event& event = file_->index.events[file_->next++];
  std::vector<char> data(static_cast<std::size_t>(event.data_bytes));
  file_->stream.clear();
  file_->stream.seekg(event.data_offset);
  Checked<Frame> frame;
  if (file_->stream.read(data.data(), event.data_bytes)) frame = decode_image(data.data(), data.size());
  // The log's own time is on another clock than the pictures, so a picture without a readable time comes just
  // after the one before it.
  if (!frame.value) frame.value = Frame{file_->last_utime + 1, {}, nullptr};
  file_->last_utime = frame.value->utime;
  return std::move(frame.value);
}

}  // namespace pilotfish::bus
