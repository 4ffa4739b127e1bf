#pragma once
// Figures of SciPy, from a script that runs here and now.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

namespace mjdiag::test {

/// Matrices by name.
using Values = std::map<std::string, Eigen::MatrixXd>;

/// Of lines "<name> <rows> <columns> <elements, row by row>".
inline Values ParseValues(const std::string& text) {
  Values values;
  std::istringstream stream(text);
  std::string name;
  Eigen::Index rows = 0;
  Eigen::Index columns = 0;
  while (stream >> name >> rows >> columns) {
    Eigen::MatrixXd matrix(rows, columns);
    for (double& value : matrix.reshaped<Eigen::RowMajor>()) stream >> value;
    values[name] = matrix;
  }
  return values;
}

/// Tests that compare with what one run of a Python script prints; skipped without SciPy,
/// but not in CI.
class ScipyTest : public testing::Test {
 public:
  static const Eigen::MatrixXd& Value(const std::string& name) {
    return values_.at(name);
  }
  static double Number(const std::string& name) { return Value(name)(0, 0); }

 protected:
  static bool HasScipy() {
    present_ = Run("-c 'import scipy.signal' 2>/dev/null", nullptr);
    return present_;
  }
  /// @param script  in the repository, with its arguments
  static void RunScript(const std::string& script) {
    std::string text;
    ASSERT_TRUE(Run(MJDIAG_SOURCE_DIR "/" + script, &text)) << script;
    values_ = ParseValues(text);
  }

  void SetUp() override {
    if (present_) return;
    const char* ci = std::getenv("CI");
    ASSERT_FALSE(ci && std::string(ci) == "true") << "python3-scipy is not installed";
    GTEST_SKIP() << "python3-scipy is not installed: no comparison with SciPy";
  }

 private:
  /// Debian's Python, which is the one that has Debian's SciPy; whether it succeeds.
  static bool Run(const std::string& arguments, std::string* text) {
    FILE* pipe = popen(("/usr/bin/python3 " + arguments).c_str(), "r");
    if (!pipe) return false;
    char block[4096];
    for (std::size_t n = 0; (n = fread(block, 1, sizeof block, pipe)) > 0;) {
      if (text) text->append(block, n);
    }
    return pclose(pipe) == 0;
  }

  inline static bool present_ = false;
  inline static Values values_;
};

/// Largest difference, relative to the largest reference value.
inline double Difference(const Eigen::MatrixXd& actual,
                         const Eigen::MatrixXd& reference) {
  if (actual.rows() != reference.rows() || actual.cols() != reference.cols()) {
    ADD_FAILURE() << "shapes differ";
    return 1.0;
  }
  return (actual - reference).cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff();
}

}  // namespace mjdiag::test
