#pragma once
// What a result says, described once. Each of its figures has a name, a unit, one line of
// text and how it is got; from that are made
//
//   JSON, `--json` and files                      fields_json.h
//   `--fields`, and the reference of the site     report/field_reference.h
//   attributes in Python, with their docstrings   python/fields.h
//   and their types in the stub                   python/stub.py
//
//   template <>
//   inline constexpr auto kFields<FaultLimit> = std::tuple{
//       Everywhere("fault", "", "The fault parameter.", &FaultLimit::fault),
//       InJson("before", "", "With the plant as given.", &FaultLimit::before)};
//
// A type whose fields are described may be the value of a field itself, alone, in a vector,
// an optional or Named.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace mjdiag {

/// Who gets a field: all, or one of them in this form.
enum class Reader { kAll, kJson, kPython };

template <typename Get, Reader kReader>
struct Field {
  const char* name;
  const char* unit;  ///< "" of what has none; "unit": the field of that name says it
  const char* text;
  Get get;  ///< a member, or a function of the result

  static constexpr bool kIsInJson = kReader != Reader::kPython;
  static constexpr bool kIsInPython = kReader != Reader::kJson;
};

template <typename Get>
constexpr Field<Get, Reader::kAll> Everywhere(const char* name, const char* unit,
                                              const char* text, Get get) {
  return {name, unit, text, get};
}
template <typename Get>
constexpr Field<Get, Reader::kJson> InJson(const char* name, const char* unit,
                                           const char* text, Get get) {
  return {name, unit, text, get};
}
template <typename Get>
constexpr Field<Get, Reader::kPython> InPython(const char* name, const char* unit,
                                               const char* text, Get get) {
  return {name, unit, text, get};
}

/// A tuple of fields of a type that has them.
struct NoFields {};
template <typename T>
inline constexpr NoFields kFields{};
template <typename T>
inline constexpr bool kHasFields =
    !std::is_same_v<std::remove_const_t<decltype(kFields<T>)>, NoFields>;

template <typename T, typename Visit>
constexpr void ForEachField(Visit visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kFields<T>);
}

/// Values by name, in an order of their own.
template <typename T>
struct Named : std::vector<std::pair<std::string, T>> {
  using std::vector<std::pair<std::string, T>>::vector;
};
template <typename Range, typename Name, typename Get>
auto NamedBy(const Range& range, Name name, Get get) {
  Named<std::decay_t<std::invoke_result_t<Get, decltype(*range.begin())>>> named;
  for (const auto& one : range) {
    named.emplace_back(std::invoke(name, one), std::invoke(get, one));
  }
  return named;
}

/// A field that is not there, and not null, where it has no value.
template <typename T>
struct IfAny : std::optional<T> {
  using std::optional<T>::optional;
};

/// What these are to whoever goes through a result.
template <typename T>
constexpr bool kIsNamed = false;
template <typename T>
constexpr bool kIsNamed<Named<T>> = true;
template <typename T>
constexpr bool kIsNamed<std::map<std::string, T>> = true;

template <typename T>
constexpr bool kIsLeftOut = false;
template <typename T>
constexpr bool kIsLeftOut<IfAny<T>> = true;

/// null in JSON where there is no text.
inline std::optional<std::string> TextOrNone(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

}  // namespace mjdiag
