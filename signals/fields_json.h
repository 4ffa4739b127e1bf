#pragma once
// A result as JSON, from the description of its fields (fields.h). Numbers without a finite
// value are null.

#include <cmath>
#include <concepts>
#include <functional>
#include <nlohmann/json.hpp>

#include "mjdiag/signals/fields.h"

namespace mjdiag {

template <typename T>
nlohmann::json JsonOf(const T& value) {
  using nlohmann::json;
  if constexpr (kHasFields<T>) {
    json object = json::object();
    ForEachField<T>([&](const auto& field) {
      if constexpr (std::decay_t<decltype(field)>::kIsInJson) {
        const auto& figure = std::invoke(field.get, value);
        if constexpr (kIsLeftOut<std::decay_t<decltype(figure)>>) {
          if (!figure) return;
        }
        object[field.name] = JsonOf(figure);
      }
    });
    return object;
  } else if constexpr (kIsNamed<T>) {
    json object = json::object();
    for (const auto& [name, one] : value) object[name] = JsonOf(one);
    return object;
  } else if constexpr (std::floating_point<T>) {
    return std::isfinite(value) ? json(value) : json();
  } else if constexpr (std::convertible_to<T, std::string> || std::integral<T>) {
    return value;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? JsonOf(*value) : json();
  } else if constexpr (requires { value.first; }) {
    return json::array({JsonOf(value.first), JsonOf(value.second)});
  } else {  // a list
    json array = json::array();
    for (const auto& one : value) array.push_back(JsonOf(one));
    return array;
  }
}

}  // namespace mjdiag
