#pragma once
// Vectors and matrices as JSON files hold them: arrays of numbers, and arrays of rows.
// Reading throws nlohmann::json::exception where there is something else.

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace mjdiag {

inline nlohmann::json VectorJson(const Eigen::VectorXd& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

inline nlohmann::json MatrixJson(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    rows.push_back(VectorJson(matrix.row(i)));
  }
  return rows;
}

inline Eigen::VectorXd VectorOf(const nlohmann::json& array) {
  const auto values = array.get<std::vector<double>>();
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// 0 x 0 of an empty array. All rows have to be of one length.
inline Eigen::MatrixXd MatrixOf(const nlohmann::json& rows) {
  const auto values = rows.get<std::vector<std::vector<double>>>();
  if (values.empty()) return {};
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(values.size()),
                         static_cast<Eigen::Index>(values.front().size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].size() != values.front().size()) {
      throw nlohmann::json::other_error::create(501, "rows of unequal length", &rows);
    }
    matrix.row(static_cast<Eigen::Index>(i)) = Eigen::VectorXd::Map(
        values[i].data(), static_cast<Eigen::Index>(values[i].size()));
  }
  return matrix;
}

/// A whole number within what `Number` holds. The library converts 1e300, too, which is
/// undefined.
template <typename Number = Eigen::Index>
Number WholeOf(const nlohmann::json& number) {
  const auto value = number.is_number_integer() ? number.get<std::int64_t>() : -1;
  if (!number.is_number_integer() || !std::in_range<Number>(value)) {
    throw nlohmann::json::type_error::create(302, "no whole number of this size",
                                             &number);
  }
  return static_cast<Number>(value);
}

}  // namespace mjdiag
