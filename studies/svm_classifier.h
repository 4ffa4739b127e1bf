#pragma once
// A support vector machine that tells the classes of feature vectors apart: healthy
// from faulty (detection) or fault from fault (isolation). It is the data-driven method
// that [AB383], Table 4 compares with.
//
// A feature is standardised by its mean and standard deviation over the training set;
// one that is constant there is left out. For two classes y = +-1 a C-SVC with
// Gaussian kernel decides by the sign of
//
//   sum_i alpha_i y_i exp(-g |z_i - z|^2) - rho,   0 <= alpha_i <= C
//
// over the standardised training vectors z_i. Several classes: one such machine a pair,
// the class that wins most pairs (the lowest label of those that win equally many).
// C and g = gamma / (number of features kept) come from a grid by k-fold
// cross-validation: the pair with most correct predictions, among equals the one with
// the smallest g, then the smallest C. Folds are stratified, drawn from the seed, and
// standardised each by its own training part. Same inputs, same bits.

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace mjdiag {

struct SvmOptions {
  /// > 0. A large C with a small gamma, an almost linear rule that keeps to every
  /// training vector, is what small faults need: do not cut that corner of the grid.
  std::vector<double> c = {0.25, 4.0, 64.0, 1024.0, 16384.0, 262144.0};
  std::vector<double> gamma = {0.001, 0.004, 0.016, 0.0625, 0.25, 1.0, 4.0};  ///< > 0
  int folds = 5;           ///< 2 to the number of vectors
  std::uint64_t seed = 1;  ///< of the folds
};

/// A trained machine. Copies share it; it never changes.
class SvmClassifier {
 public:
  /// @param features  one vector a row
  /// @param labels    the class of every row, any numbers
  /// InputError if the sizes differ, there are fewer than two classes or fewer than two
  /// vectors of one, a value is not finite, no feature varies, or an option is out of
  /// range.
  static SvmClassifier Train(const Eigen::MatrixXd& features,
                             const std::vector<int>& labels,
                             const SvmOptions& options = {});

  /// The label of one vector, or of every row. InputError on another number of features
  /// than trained with or a value that is not finite.
  int Predict(const Eigen::VectorXd& features) const;
  std::vector<int> PredictRows(const Eigen::MatrixXd& features) const;

  /// With two classes: the sum above, negative for the lower label, else positive. A
  /// study can move its threshold away from 0 to trade false alarms for misses.
  /// InputError as for Predict, and with more classes.
  double DecisionValue(const Eigen::VectorXd& features) const;

  const std::vector<int>& labels() const;  ///< of the classes, ascending
  double c() const;                        ///< C chosen
  double gamma() const;                    ///< g times features_kept() chosen
  Eigen::Index features_kept() const;
  /// Part of the training set predicted right in cross-validation at that C and gamma.
  /// As they were chosen for it, a little too good.
  double validation_accuracy() const;

 private:
  struct Model;
  explicit SvmClassifier(std::shared_ptr<const Model> model);

  std::shared_ptr<const Model> model_;
};

/// How predictions compare with the truth.
struct Confusion {
  std::vector<int> labels;  ///< ascending
  Eigen::MatrixXi counts;   ///< (i, j): vectors of class i predicted as class j

  double accuracy() const;
  /// Part of the healthy vectors predicted as a fault; NaN without healthy ones.
  double false_alarm_rate(int healthy) const;
  /// Part of the faulty vectors predicted as healthy; NaN without faulty ones.
  double missed_detection_rate(int healthy) const;
};

/// InputError if the lists are empty or of different length.
Confusion CountConfusion(const std::vector<int>& actual,
                         const std::vector<int>& predicted);

}  // namespace mjdiag
