#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Configurations that are made of others form a tree. A struct with parts lists them once,
///
///     template <class Visit>
///     static void sections(Visit&& visit) {
///       visit("limits", &FollowerConfig::limits);     // the section `limits` of this one
///       visit("", &LeaderObserverConfig::detector);   // a part whose keys stand in this section itself
///     }
///
/// and whatever walks the tree (the reader, the range check, the documentation, the schema, the Python binding) finds
/// its parts there and its numbers in parameters(). Either may be missing.
namespace sections_detail {
struct NullVisitor {
  template <class Member>
  void operator()(const char*, Member) const {}
};
template <class Config, class = void>
struct HasSections : std::false_type {};
template <class Config>
struct HasSections<Config, std::void_t<decltype(Config::sections(NullVisitor{}))>> : std::true_type {};
template <class Config, class = void>
struct HasParameters : std::false_type {};
template <class Config>
struct HasParameters<Config, std::void_t<decltype(Config::parameters())>> : std::true_type {};
}  // namespace sections_detail

template <class Config>
inline constexpr bool kHasSections = sections_detail::HasSections<Config>::value;
template <class Config>
inline constexpr bool kHasParameters = sections_detail::HasParameters<Config>::value;

/// check_ranges() of the whole tree below `section`. Throws ConfigError with the dotted key.
template <class Config>
void check_tree(const Config& config, const std::string& section) {
  if constexpr (kHasParameters<Config>) check_ranges(config, section);
  if constexpr (kHasSections<Config>)
    Config::sections([&](std::string_view name, auto member) {
      check_tree(config.*member, name.empty() ? section : dotted(section, name));
    });
}

}  // namespace pilotfish
PILOTFISH_API_END
