// Truth: conditions of Karush, Kuhn and Tucker, problems with known answers, and answers made from few.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "app/planning/spectral_choice.hpp"

namespace cloudbow {
namespace {

// The same numbers everywhere: the output of mt19937 is fixed by the standard.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_()) / 4294967296.; }

 private:
  std::mt19937 engine_;
};

std::vector<double> random_vector(Random& random, std::size_t n, double least = 0) {
  std::vector<double> values(n);
  for (double& v : values) v = least + (1 - least) * random();
  return values;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
}

// b - A x
std::vector<double> rest(const std::vector<std::vector<double>>& columns, const std::vector<double>& b,
                         const std::vector<double>& x) {
  std::vector<double> r = b;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (std::size_t i = 0; i < r.size(); ++i) r[i] -= x[j] * columns[j][i];
  }
  return r;
}

// x >= 0; A^T (b - A x) is 0 if x > 0, and not positive otherwise.
void expect_optimal(const std::vector<std::vector<double>>& columns, const std::vector<double>& b,
                    const std::vector<double>& x, const std::string& name) {
  ASSERT_EQ(x.size(), columns.size());
  const std::vector<double> r = rest(columns, b, x);
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double rounding = 1e-11 * std::sqrt(dot(columns[j], columns[j]) * dot(b, b));
    const double gradient = dot(columns[j], r);
    EXPECT_GE(x[j], 0) << name;
    EXPECT_LE(gradient, rounding) << name << ' ' << j;
    if (x[j] > 0) {
      EXPECT_GE(gradient, -rounding) << name << ' ' << j;
    }
  }
}

TEST(NonNegativeLeastSquares, OfOneColumnIsAProjection) {
  const std::vector<std::vector<double>> one{{3, 4}};
  EXPECT_NEAR(non_negative_least_squares(one, std::vector<double>{1, 2})[0], 11. / 25, 1e-15);
  EXPECT_EQ(non_negative_least_squares(one, std::vector<double>{-1, 0})[0], 0);
  EXPECT_EQ(non_negative_least_squares(one, std::vector<double>{0, 0})[0], 0);
}

// Perpendicular columns: each x is its own projection, or 0.
TEST(NonNegativeLeastSquares, OfPerpendicularColumnsIsTheirPositivePart) {
  const std::vector<std::vector<double>> columns{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
  const std::vector<double> x = non_negative_least_squares(columns, std::vector<double>{4, -5, 2});
  EXPECT_NEAR(x[0], 2, 1e-15);
  EXPECT_EQ(x[1], 0);
  EXPECT_NEAR(x[2], .5, 1e-15);
}

// Without the constraint x = (2, -1), so that the answer is that of the first column alone: 1.5.
TEST(NonNegativeLeastSquares, LeavesOutAColumnThatWouldBeNegative) {
  const std::vector<std::vector<double>> columns{{1, 1}, {0, 1}};
  const std::vector<double> x = non_negative_least_squares(columns, std::vector<double>{2, 1});
  EXPECT_NEAR(x[0], 1.5, 1e-15);
  EXPECT_EQ(x[1], 0);
}

TEST(NonNegativeLeastSquares, OfRandomProblemsIsOptimal) {
  Random random(3);
  for (int n = 1; n <= 40; n += 3) {
    for (const double least : {-1., -.2, 0.}) {
      for (const std::size_t rows : {5, 30, 200}) {
        std::vector<std::vector<double>> columns;
        for (int j = 0; j < n; ++j) {
          columns.push_back(random_vector(random, rows, least));
          for (double& v : columns.back()) v *= std::pow(10., j % 5 - 2);
        }
        const std::vector<double> b = random_vector(random, rows, least);
        expect_optimal(columns, b, non_negative_least_squares(columns, b), std::to_string(n));
      }
    }
  }
}

TEST(NonNegativeLeastSquares, MayHaveColumnsThatDependOnOthersOrAreEmpty) {
  Random random(4);
  std::vector<std::vector<double>> columns{std::vector<double>(20, 0.)};
  for (int j = 0; j < 6; ++j) {
    columns.push_back(random_vector(random, 20));
    columns.push_back(columns.back());
    for (double& v : columns.back()) v *= 3;
  }
  const std::vector<double> b = random_vector(random, 20, -.5);
  const std::vector<double> x = non_negative_least_squares(columns, b);
  expect_optimal(columns, b, x, "dependent");
  EXPECT_EQ(x[0], 0);
}

TEST(NonNegativeLeastSquares, FindsWhatLiesInTheCone) {
  Random random(5);
  std::vector<std::vector<double>> columns;
  for (int j = 0; j < 20; ++j) columns.push_back(random_vector(random, 100));
  std::vector<double> truth(20, 0.), b(100, 0.);
  for (const std::size_t j : {2, 7, 8, 19}) truth[j] = 1 + static_cast<double>(j);
  for (double& v : b) v = 0;
  for (std::size_t j = 0; j < 20; ++j) {
    for (std::size_t i = 0; i < b.size(); ++i) b[i] += truth[j] * columns[j][i];
  }
  const std::vector<double> x = non_negative_least_squares(columns, b);
  for (std::size_t j = 0; j < 20; ++j) EXPECT_NEAR(x[j], truth[j], 1e-11);
}

// Answers that vary smoothly from g-point to g-point and from column to column, as those of gas and cloud do.
std::vector<ColumnAnswers> smooth_answers(int points, std::size_t columns, bool heating = true) {
  std::vector<ColumnAnswers> answers;
  for (int g = 0; g < points; ++g) {
    ColumnAnswers answer;
    answer.power = 1 + (7 * g) % 5;
    const double gas = 1e-3 * std::pow(1e5, g / (points - 1.)), droplets = .3 * ((3 * g) % 7) / 7.;
    for (std::size_t c = 0; c < columns; ++c) {
      const double depth = 40. * static_cast<double>(c * c) / static_cast<double>(columns * columns);
      answer.up.push_back(std::exp(-gas) * depth / (depth + 8) * (1 - droplets));
      answer.down.push_back(std::exp(-2 * gas) * 8 / (depth + 8));
      answer.absorbed.push_back(1 - answer.up.back() - answer.down.back());
    }
    if (heating) {
      for (int k = 0; k < 10; ++k) answer.heating.push_back(gas * std::exp(-gas * k));
    }
    answers.push_back(answer);
  }
  return answers;
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.); }

double sum_of_powers(const std::vector<ColumnAnswers>& answers) {
  double sum = 0;
  for (const ColumnAnswers& answer : answers) sum += answer.power;
  return sum;
}

// Every g-point is a mixture of three, so these stand for all.
TEST(SpectralChoice, FindsTheFewOfWhichAllConsist) {
  Random random(6);
  const std::vector<ColumnAnswers> corner = smooth_answers(3, 30, false);
  std::vector<ColumnAnswers> answers;
  for (int g = 0; g < 20; ++g) {
    std::array<double, 3> share{random(), random(), random()};
    if (g == 4 || g == 9 || g == 17) share = {double(g == 4), double(g == 9), double(g == 17)};
    const double all = share[0] + share[1] + share[2];
    ColumnAnswers mixed;
    mixed.power = .5 + random();
    mixed.up = mixed.down = mixed.absorbed = std::vector<double>(30, 0.);
    for (std::size_t c = 0; c < 30; ++c) {
      for (std::size_t s = 0; s < 3; ++s) {
        mixed.up[c] += share[s] / all * corner[s].up[c];
        mixed.down[c] += share[s] / all * corner[s].down[c];
        mixed.absorbed[c] += share[s] / all * corner[s].absorbed[c];
      }
    }
    answers.push_back(mixed);
  }
  const SpectralChoice choice = choose_points(answers, 1e-10);
  EXPECT_LE(choice.point.size(), 3U);
  EXPECT_LT(choice.residual, 1e-10);
  // Of the three corners alone the answer is exact.
  const std::vector<ColumnAnswers> copies{answers[4], answers[9], answers[17], answers[4]};
  const SpectralChoice of_copies = choose_points(copies, 1e-10);
  EXPECT_EQ(of_copies.point, (std::vector<int>{0, 1, 2}));
  ASSERT_EQ(of_copies.weight.size(), 3U);
  EXPECT_NEAR(of_copies.weight[0], 2 * answers[4].power, 1e-9);
  EXPECT_NEAR(of_copies.weight[1], answers[9].power, 1e-9);
  EXPECT_NEAR(of_copies.weight[2], answers[17].power, 1e-9);
}

// The row of the sum counts 1e4 times the square of others.
TEST(SpectralChoice, KeepsTheSum) {
  const std::vector<ColumnAnswers> answers = smooth_answers(32, 64);
  const double power = sum_of_powers(answers);
  for (int points = 1; points <= 8; ++points) {
    const SpectralChoice choice = choose_points(answers, 0, points);
    EXPECT_NEAR(sum_of(choice.weight), power, 1e-3 * choice.residual * power) << points;
    EXPECT_LE(choice.point.size(), static_cast<std::size_t>(points));
    EXPECT_TRUE(std::is_sorted(choice.point.begin(), choice.point.end()));
    for (const double weight : choice.weight) EXPECT_GT(weight, 0);
  }
}

TEST(SpectralChoice, WithMorePointsIsNeverWorse) {
  const std::vector<ColumnAnswers> answers = smooth_answers(32, 64);
  double before = 1e9;
  for (const int points : {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 32}) {
    const double residual = choose_points(answers, 0, points).residual;
    EXPECT_LE(residual, std::max(before, 1e-9) * (1 + 1e-9)) << points;
    before = residual;
  }
  EXPECT_EQ(before, 0);
}

// The residual is that of the rows as they are named.
TEST(SpectralChoice, ResidualIsTheRelativeError) {
  const std::vector<ColumnAnswers> answers = smooth_answers(16, 20);
  const SpectralChoice choice = choose_points(answers, 0, 4);
  double squares = 0;
  const auto count = [&](std::vector<double> ColumnAnswers::*field, bool largest) {
    std::vector<double> truth((answers[0].*field).size(), 0.), found = truth;
    for (const ColumnAnswers& answer : answers) {
      for (std::size_t i = 0; i < truth.size(); ++i) truth[i] += answer.power * (answer.*field)[i];
    }
    for (std::size_t n = 0; n < choice.point.size(); ++n) {
      for (std::size_t i = 0; i < truth.size(); ++i)
        found[i] += choice.weight[n] * (answers[choice.point[n]].*field)[i];
    }
    const auto size = static_cast<double>(truth.size());
    const double unit = largest ? *std::max_element(truth.begin(), truth.end()) / .3
                                : std::max(sum_of(truth) / size, .5 * std::sqrt(dot(truth, truth) / size));
    for (std::size_t i = 0; i < truth.size(); ++i) squares += std::pow((found[i] - truth[i]) / unit, 2) / size;
  };
  count(&ColumnAnswers::up, false);
  count(&ColumnAnswers::down, false);
  count(&ColumnAnswers::absorbed, false);
  count(&ColumnAnswers::heating, true);
  EXPECT_NEAR(choice.residual, std::sqrt(squares), 1e-3 * choice.residual);
}

TEST(SpectralChoice, OfAllHasTheirPowersAndNoResidual) {
  std::vector<ColumnAnswers> answers = smooth_answers(7, 16);
  answers[2].power = 0;
  for (const SpectralChoice& choice : {choose_points(answers, 0), choose_points(answers, 0, 32)}) {
    EXPECT_EQ(choice.point, (std::vector<int>{0, 1, 3, 4, 5, 6}));
    for (std::size_t i = 0; i < choice.point.size(); ++i) EXPECT_EQ(choice.weight[i], answers[choice.point[i]].power);
    EXPECT_EQ(choice.residual, 0);
  }
  EXPECT_EQ(choose_points(std::vector<ColumnAnswers>{answers[2]}, 1e-3).point.size(), 0U);
  EXPECT_EQ(choose_points(std::vector<ColumnAnswers>{answers[3]}, 1e-3).point, std::vector<int>{0});
}

// The difference of the sums, by level; all g-points together lack nothing.
TEST(SpectralChoice, ReportsWhatIsMissing) {
  std::vector<ColumnAnswers> answers = smooth_answers(9, 16);
  for (std::size_t g = 0; g < answers.size(); ++g) {
    const auto value = static_cast<double>(g * g + 1);
    answers[g].means = {{value, 2 * value, 3 * value}, {0, 0, value}, {value, 0, 0}, {5, -value}};
  }
  double of_all = 0, powers = 0;
  for (std::size_t g = 0; g < answers.size(); ++g) {
    of_all += answers[g].power * static_cast<double>(g * g + 1);
    powers += answers[g].power;
  }
  const SpectralChoice choice = choose_points(answers, 0, 3);
  double of_chosen = 0;
  for (std::size_t i = 0; i < choice.point.size(); ++i)
    of_chosen += choice.weight[i] * (choice.point[i] * choice.point[i] + 1);
  const double missing = of_all - of_chosen, rounding = 1e-12 * of_all;
  ASSERT_EQ(choice.missing.up.size(), 3U);
  EXPECT_NEAR(choice.missing.up[2], 3 * missing, 3 * rounding);
  EXPECT_NEAR(choice.missing.down_diffuse[2], missing, rounding);
  EXPECT_NEAR(choice.missing.direct[0], missing, rounding);
  ASSERT_EQ(choice.missing.absorbed.size(), 2U);
  EXPECT_NEAR(choice.missing.absorbed[1], -missing, rounding);
  EXPECT_NEAR(choice.missing.absorbed[0], 5 * (powers - sum_of(choice.weight)), 1e-10 * powers);
  for (const double up : choose_points(answers, 0).missing.up) EXPECT_EQ(up, 0);
}

TEST(SpectralChoice, EndsAtTheTolerance) {
  const std::vector<ColumnAnswers> answers = smooth_answers(32, 64);
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    const SpectralChoice choice = choose_points(answers, tolerance);
    EXPECT_LE(choice.residual, tolerance);
    const auto fewer = static_cast<int>(choice.point.size()) - 1;
    if (fewer > 0) {
      EXPECT_GT(choose_points(answers, 0, fewer).residual, tolerance);
    }
  }
}

// Fields whose mean is 0, as net absorption can have it, and fields of nothing.
TEST(SpectralChoice, HasAUnitForEveryField) {
  std::vector<ColumnAnswers> answers = smooth_answers(12, 16);
  for (ColumnAnswers& answer : answers) {
    for (std::size_t c = 0; c < 16; ++c) {
      answer.absorbed[c] *= c % 2 == 0 ? 1 : -1;
      answer.down[c] = 0;
    }
  }
  const SpectralChoice choice = choose_points(answers, 1e-3);
  EXPECT_LE(choice.residual, 1e-3);
  EXPECT_NEAR(sum_of(choice.weight), sum_of_powers(answers), 1e-5 * sum_of_powers(answers));
}

TEST(SpectralChoice, DoesNotDependOnTheUnitOfPower) {
  std::vector<ColumnAnswers> answers = smooth_answers(20, 32);
  const SpectralChoice choice = choose_points(answers, 1e-3);
  for (ColumnAnswers& answer : answers) answer.power *= 1e-6;
  const SpectralChoice other = choose_points(answers, 1e-3);
  EXPECT_EQ(choice.point, other.point);
  for (std::size_t i = 0; i < other.weight.size(); ++i)
    EXPECT_NEAR(other.weight[i], 1e-6 * choice.weight[i], 1e-15 * choice.weight[i]);
}

TEST(SpectralChoice, HasTheSameBitsAgain) {
  const std::vector<ColumnAnswers> answers = smooth_answers(32, 64);
  const SpectralChoice choice = choose_points(answers, 1e-4);
  for (int again = 0; again < 3; ++again) {
    const SpectralChoice other = choose_points(answers, 1e-4);
    EXPECT_EQ(choice.point, other.point);
    EXPECT_EQ(choice.weight, other.weight);
    EXPECT_EQ(choice.residual, other.residual);
  }
}

}  // namespace
}  // namespace cloudbow
