// Truth: the results and errors that were sent.
#include <gtest/gtest.h>

#include <stdexcept>

#include "../../thread_ranks.hpp"
#include "app/process/rank_messages.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

template <class Error>
void send(Ranks& ranks, const Error& error) {
  try {
    throw error;
  } catch (...) {
    send_error(ranks);
  }
}

TEST(RankMessages, ResultsAndErrorsKeepTheirKind) {
  ThreadRanks::run(2, [](Ranks& ranks) {
    const std::vector<std::byte> result(10, std::byte{3});
    if (!ranks.is_first()) {
      send_result(ranks, result);
      send(ranks, InputError("scene.toml: wrong"));
      send(ranks, std::runtime_error("diverges"));
      send(ranks, std::bad_alloc());
      send_result(ranks, {});
      EXPECT_THROW(send(ranks, 7), int) << "an interrupt";
      return;
    }
    EXPECT_EQ(receive_result(ranks, 1), result);
    EXPECT_THROW(receive_result(ranks, 1), InputError);
    try {
      receive_result(ranks, 1);
      ADD_FAILURE();
    } catch (const InputError&) {
      ADD_FAILURE() << "another kind of error";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "diverges");
    }
    EXPECT_THROW(receive_result(ranks, 1), InputError) << "as in one process: too little memory";
    EXPECT_TRUE(receive_result(ranks, 1).empty());
  });
}

}  // namespace
}  // namespace cloudbow
