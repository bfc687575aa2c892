// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/supernodal_factors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

namespace lapwing {
namespace {

using Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;
using Reference = Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>>;
using Places = std::vector<std::pair<int, int>>;

// Symmetric with these places off the diagonal, quasi-definite: columns are positive or negative at
// random, and outweigh their neighbours of the same sign.
Matrix quasi_definite(int n, const Places& places, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<double> diagonal(n);
  std::vector<char> positive(n);
  for (int i = 0; i < n; ++i) {
    positive[i] = number(random) > -0.2;
    diagonal[i] = 0.1 + std::abs(number(random));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [i, j] : places) {
    const double value = number(random);
    entries.emplace_back(std::min(i, j), std::max(i, j), value);
    if (positive[i] != positive[j]) continue;
    diagonal[i] += std::abs(value);
    diagonal[j] += std::abs(value);
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, positive[i] ? diagonal[i] : -diagonal[i]);
  Matrix upper(n, n);
  upper.setFromTriplets(entries.begin(), entries.end());
  return upper;
}

VectorXd random_vector(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  VectorXd v(n);
  for (int i = 0; i < n; ++i) v(i) = number(random);
  return v;
}

void expect_like_reference(SupernodalFactors& factors, const Matrix& upper, std::mt19937& random) {
  ASSERT_TRUE(factors.factorise(upper));
  Reference reference(upper);
  ASSERT_EQ(reference.info(), Eigen::Success);
  for (int k = 0; k < 2; ++k) {
    const VectorXd right = random_vector(static_cast<int>(upper.cols()), random);
    VectorXd x = right;
    factors.solve(x);
    const VectorXd expected = reference.solve(right);
    EXPECT_LE((x - expected).norm(), 1e-9 * (1.0 + expected.norm()));
    const VectorXd left = upper.selfadjointView<Eigen::Upper>() * x - right;
    EXPECT_LE(left.norm(), 1e-9 * (1.0 + x.norm()));
  }
}

void expect_all_shapes_of(int n, const Places& places, std::mt19937& random) {
  SupernodalFactors factors;
  const Matrix upper = quasi_definite(n, places, random);
  factors.analyse(upper);
  expect_like_reference(factors, upper, random);
  // The analysis serves other values, the last of which leave nothing behind.
  expect_like_reference(factors, quasi_definite(n, places, random), random);
  expect_like_reference(factors, upper, random);
}

Places dense(int n) {
  Places places;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < j; ++i) places.emplace_back(i, j);
  return places;
}

Places banded(int n, int width) {
  Places places;
  for (int j = 0; j < n; ++j)
    for (int i = std::max(0, j - width); i < j; ++i) places.emplace_back(i, j);
  return places;
}

TEST(SupernodalFactors, NothingAndOneNumber) {
  SupernodalFactors factors;
  factors.analyse(Matrix(0, 0));
  EXPECT_TRUE(factors.factorise(Matrix(0, 0)));
  VectorXd none(0);
  factors.solve(none);
  Matrix one(1, 1);
  one.insert(0, 0) = -4.0;
  one.makeCompressed();
  factors.analyse(one);
  ASSERT_TRUE(factors.factorise(one));
  VectorXd x = VectorXd::Constant(1, 2.0);
  factors.solve(x);
  EXPECT_EQ(x(0), -0.5);
}

// [2 1; 1 -1] x = [4; -1]: x = [1; 2].
TEST(SupernodalFactors, KnownAnswer) {
  Matrix upper(2, 2);
  upper.insert(0, 0) = 2.0;
  upper.insert(0, 1) = 1.0;
  upper.insert(1, 1) = -1.0;
  upper.makeCompressed();
  SupernodalFactors factors;
  factors.analyse(upper);
  ASSERT_TRUE(factors.factorise(upper));
  VectorXd x(2);
  x << 4.0, -1.0;
  factors.solve(x);
  EXPECT_NEAR(x(0), 1.0, 1e-14);
  EXPECT_NEAR(x(1), 2.0, 1e-14);
}

TEST(SupernodalFactors, DiagonalAndDense) {
  std::mt19937 random(1);
  for (int n = 1; n <= 40; ++n) {
    SCOPED_TRACE("n " + std::to_string(n));
    expect_all_shapes_of(n, {}, random);
    expect_all_shapes_of(n, dense(n), random);
  }
  expect_all_shapes_of(131, dense(131), random);
}

TEST(SupernodalFactors, Arrows) {
  std::mt19937 random(2);
  for (int n : {2, 5, 64, 300}) {
    SCOPED_TRACE("n " + std::to_string(n));
    Places tip_last, tip_first, thick;
    for (int i = 0; i + 1 < n; ++i) tip_last.emplace_back(i, n - 1);
    for (int i = 1; i < n; ++i) tip_first.emplace_back(0, i);
    for (int i = 0; i + 7 < n; ++i)
      for (int k = n - 7; k < n; ++k) thick.emplace_back(i, k);
    expect_all_shapes_of(n, tip_last, random);
    expect_all_shapes_of(n, tip_first, random);  // fills in completely
    expect_all_shapes_of(n, thick, random);
  }
}

TEST(SupernodalFactors, Bands) {
  std::mt19937 random(3);
  for (int width : {1, 2, 3, 4, 5, 9, 30}) {
    SCOPED_TRACE("width " + std::to_string(width));
    expect_all_shapes_of(200, banded(200, width), random);
  }
}

TEST(SupernodalFactors, ForestsOfSeparatePieces) {
  std::mt19937 random(4);
  Places interleaved;  // seven bands, a piece's columns seven apart; every eleventh column alone
  for (int j = 0; j < 280; ++j)
    for (int i : {j - 7, j - 14})
      if (i >= 0 && i % 11 != 0 && j % 11 != 0) interleaved.emplace_back(i, j);
  expect_all_shapes_of(280, interleaved, random);
}

TEST(SupernodalFactors, RandomPatterns) {
  std::mt19937 random(5);
  for (int n : {3, 17, 60, 250})
    for (double share : {0.5, 1.5, 4.0})
      for (int seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(std::to_string(n) + ", " + std::to_string(share));
        std::uniform_int_distribution<int> column(0, n - 1);
        Places places;
        for (int k = 0; k < share * n; ++k) {
          const int i = column(random), j = column(random);
          const std::pair<int, int> place = std::minmax(i, j);
          if (i != j && std::find(places.begin(), places.end(), place) == places.end())
            places.push_back(place);
        }
        expect_all_shapes_of(n, places, random);
      }
}

// Another pattern after a first: nothing is kept of it.
TEST(SupernodalFactors, AnalysedAgain) {
  std::mt19937 random(6);
  SupernodalFactors factors;
  for (int n : {50, 8, 120}) {
    const Matrix upper = quasi_definite(n, banded(n, n / 4), random);
    factors.analyse(upper);
    expect_like_reference(factors, upper, random);
  }
}

TEST(SupernodalFactors, SameNumbersEveryTime) {
  std::mt19937 random(7);
  const Matrix upper = quasi_definite(300, banded(300, 6), random);
  const VectorXd right = random_vector(300, random);
  SupernodalFactors first, second;
  first.analyse(upper);
  second.analyse(upper);
  ASSERT_TRUE(first.factorise(quasi_definite(300, banded(300, 6), random)));
  ASSERT_TRUE(first.factorise(upper));
  ASSERT_TRUE(second.factorise(upper));
  VectorXd x = right, y = right;
  first.solve(x);
  second.solve(y);
  EXPECT_EQ(x, y);
}

// As many negative pivots as negative eigenvalues, whatever the order.
TEST(SupernodalFactors, NegativePivotsCountEigenvalues) {
  std::mt19937 random(9);
  for (int n : {1, 2, 9, 40})
    for (int k = 0; k < 10; ++k) {
      Matrix upper(n, n);
      std::uniform_real_distribution<double> number(-1.0, 1.0);
      Eigen::MatrixXd whole(n, n);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i <= j; ++i) whole(i, j) = whole(j, i) = number(random);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i <= j; ++i) upper.insert(i, j) = whole(i, j);
      upper.makeCompressed();
      SupernodalFactors factors;
      factors.analyse(upper);
      ASSERT_TRUE(factors.factorise(upper));
      const VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(whole).eigenvalues();
      EXPECT_EQ(factors.negative_pivots(), (values.array() < 0).count()) << n;
    }
}

TEST(SupernodalFactors, BadPivotsAreReported) {
  std::mt19937 random(8);
  const int n = 30;
  const Matrix sound = quasi_definite(n, banded(n, 3), random);
  SupernodalFactors factors;
  factors.analyse(sound);
  for (int i = 0; i < n; ++i) {
    SCOPED_TRACE("column " + std::to_string(i));
    for (double bad :
         {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Matrix upper = sound;
      upper.coeffRef(i, i) = bad;
      for (int j = 0; j < n; ++j)  // nothing else in this row and column
        for (Matrix::InnerIterator e(upper, j); e; ++e)
          if (e.row() != j && (e.row() == i || j == i)) e.valueRef() = 0.0;
      EXPECT_FALSE(factors.factorise(upper));
    }
  }
  expect_like_reference(factors, sound, random);
}

// Singular through what elimination leaves: [1 2; 2 4].
TEST(SupernodalFactors, ZeroPivotOfElimination) {
  Matrix upper(2, 2);
  upper.insert(0, 0) = 1.0;
  upper.insert(0, 1) = 2.0;
  upper.insert(1, 1) = 4.0;
  upper.makeCompressed();
  SupernodalFactors factors;
  factors.analyse(upper);
  EXPECT_FALSE(factors.factorise(upper));
}

TEST(SupernodalFactors, EmptyColumnIsSingular) {
  Matrix upper(3, 3);
  upper.insert(0, 0) = 1.0;
  upper.insert(0, 2) = 0.5;
  upper.insert(2, 2) = -1.0;
  upper.makeCompressed();
  SupernodalFactors factors;
  factors.analyse(upper);
  EXPECT_FALSE(factors.factorise(upper));
}

// A column without a diagonal gets its pivot from those before it.
TEST(SupernodalFactors, DiagonalLeftOut) {
  Matrix upper(2, 2);
  upper.insert(0, 0) = 2.0;
  upper.insert(0, 1) = 2.0;
  upper.makeCompressed();
  SupernodalFactors factors;
  factors.analyse(upper);
  ASSERT_TRUE(factors.factorise(upper));
  VectorXd x(2);
  x << 6.0, 2.0;
  factors.solve(x);
  EXPECT_NEAR(x(0), 1.0, 1e-14);
  EXPECT_NEAR(x(1), 2.0, 1e-14);
}

}  // namespace
}  // namespace lapwing
