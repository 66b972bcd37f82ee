// Words that may be meant. Truth: Levenshtein's distance by hand.
#include <gtest/gtest.h>

#include "app/process/suggestion.hpp"

namespace cloudbow {
namespace {

TEST(Suggestion, NamesTheNearestWordWithinTwoSlips) {
  EXPECT_EQ(candidates_for("albdo", {"albedo", "slope"}), "albedo, slope; did you mean albedo?");
  EXPECT_EQ(candidates_for("adelbo", {"albedo", "slope"}), "albedo, slope") << "four letters differ";
  EXPECT_EQ(candidates_for("ab", {"cd"}), "cd; did you mean cd?") << "two slips";
  EXPECT_EQ(candidates_for("ab", {"cde"}), "cde") << "three";
}

TEST(Suggestion, LongWordsMayDifferInAThirdOfTheirLetters) {
  EXPECT_EQ(candidates_for("asymetriparamter", {"asymmetry_parameter"}),
            "asymmetry_parameter; did you mean asymmetry_parameter?");
}

TEST(Suggestion, AWordCutShortIsOneSlip) {
  EXPECT_EQ(candidates_for("zen", {"sun", "zenith_deg"}), "sun, zenith_deg; did you mean zenith_deg?");
}

TEST(Suggestion, NoCandidatesAreNoSuggestion) { EXPECT_EQ(candidates_for("a", {}), ""); }

}  // namespace
}  // namespace cloudbow
