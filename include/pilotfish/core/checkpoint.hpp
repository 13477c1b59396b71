#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

using Bytes = std::vector<std::uint8_t>;

/// An object's state, as bytes and back, bit for bit: so that a recording can be replayed from its middle. A
/// class lists its state once, for both directions:
///
///   template <class Self, class Archive>
///   static void remember(Self& self, Archive& archive) { archive(self.started_, self.utime_); }
///
/// Configuration is not part of it. The bytes are only for the same build of the program; they have no version and no
/// byte order of their own.
class CheckpointWriter {
 public:
  static constexpr bool kReads = false;  ///< it writes
  /// Appends to `bytes`.
  explicit CheckpointWriter(Bytes& bytes) : bytes_(bytes) {}
  /// Writes values, one after the other.
  template <class... T>
  void operator()(const T&... values);
  /// Writes bytes as they are.
  void raw(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

 private:
  Bytes& bytes_;
};

/// After a read beyond the end, or a count that is too large, nothing more is read.
class CheckpointReader {
 public:
  static constexpr bool kReads = true;  ///< it reads
  /// Reads from the beginning of `bytes`.
  explicit CheckpointReader(const Bytes& bytes) : next_(bytes.data()), left_(bytes.size()) {}
  /// Reads values in the order in which they were written.
  template <class... T>
  void operator()(T&... values);
  /// Not inlined: otherwise GCC 12 warns of a write behind an array's end in a branch that is never reached.
  [[gnu::noinline]] void raw(void* data, std::size_t size) {
    if (size > left_) return fail();
    std::memcpy(data, next_, size);
    next_ += size;
    left_ -= size;
  }
  void fail() { left_ = 0, sound_ = false; }              ///< marks what was read as invalid
  bool read_all() const { return sound_ && left_ == 0; }  ///< no byte is missing or left

 private:
  const std::uint8_t* next_;
  std::size_t left_;
  bool sound_ = true;
};

namespace checkpoint {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsList : std::false_type {};
template <class T, std::size_t N>
struct IsList<BoundedVector<T, N>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t N>
struct IsArray<std::array<T, N>> : std::true_type {};
template <class T, class Archive, class = void>
struct Remembers : std::false_type {};
template <class T, class Archive>
struct Remembers<T, Archive, std::void_t<decltype(T::remember(std::declval<T&>(), std::declval<Archive&>()))>>
    : std::true_type {};

template <class Archive, class T>
void transfer_list(Archive& archive, T& list) {
  std::uint64_t size = list.size();
  archive(size);
  if constexpr (Archive::kReads) {
    if (size > T::capacity()) return archive.fail();
    list.clear();
    for (std::uint64_t i = 0; i < size; ++i) list.push_back({});
  }
  for (auto& element : list) archive(element);
}

template <class Archive, class T>
void transfer(Archive& archive, T& value) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Value, bool>) {
    auto byte = static_cast<std::uint8_t>(value ? 1 : 0);  // whatever is read, a bool is 0 or 1
    archive.raw(&byte, 1);
    if constexpr (Archive::kReads) value = byte != 0;
  } else if constexpr (IsOptional<Value>::value) {
    bool there = value.has_value();
    archive(there);
    if constexpr (Archive::kReads) {
      if (there) value.emplace();
      if (!there) value.reset();
    }
    if (there) archive(*value);
  } else if constexpr (IsList<Value>::value) {
    transfer_list(archive, value);
  } else if constexpr (IsArray<Value>::value) {
    for (auto& element : value) archive(element);
  } else if constexpr (std::is_base_of_v<Eigen::EigenBase<Value>, Value>) {
    archive.raw(value.data(), sizeof(typename Value::Scalar) * static_cast<std::size_t>(Value::SizeAtCompileTime));
  } else if constexpr (std::is_same_v<Value, Eigen::Isometry3d>) {
    archive(value.matrix());
  } else if constexpr (Remembers<T, Archive>::value) {
    Value::remember(value, archive);
  } else {
    // Numbers, and structs of 8-byte numbers: no pointer, no padding.
    static_assert(std::is_trivially_copyable_v<Value>);
    static_assert(std::is_arithmetic_v<Value> || (alignof(Value) == 8 && std::is_standard_layout_v<Value>));
    archive.raw(&value, sizeof value);
  }
}

}  // namespace checkpoint

template <class... T>
void CheckpointWriter::operator()(const T&... values) {
  (checkpoint::transfer(*this, values), ...);
}
template <class... T>
void CheckpointReader::operator()(T&... values) {
  (checkpoint::transfer(*this, values), ...);
}

}  // namespace pilotfish
PILOTFISH_API_END
