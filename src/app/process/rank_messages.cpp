#include "app/process/rank_messages.hpp"

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "app/process/exit_codes.hpp"
#include "cloudbow/core/bytes.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

/// The end of some work at another rank.
struct RemoteEnd {
  int exit_code = exit_done;
  std::string message{};
};

template <class Archive>
void visit_members(Archive& archive, RemoteEnd& end) {
  archive(end.exit_code, end.message);
}

void send_end(Ranks& ranks, const RemoteEnd& end) {
  ByteWriter writer;
  writer(end);
  send_bytes(ranks, 0, writer.take());
}

/// Interrupts are no std::exception.
RemoteEnd end_of_current_exception() {
  try {
    throw;
  } catch (const InputError& error) {
    return {exit_input_error, error.what()};
  } catch (const std::bad_alloc&) {
    return {exit_input_error, "out of memory (a smaller domain, a lower solver.accuracy or fewer --threads need less)"};
  } catch (const std::exception& error) {
    return {exit_internal_error, error.what()};
  }
}

}  // namespace

void send_result(Ranks& ranks, std::span<const std::byte> result) {
  send_end(ranks, {});
  send_bytes(ranks, 0, result);
}

void send_error(Ranks& ranks) { send_end(ranks, end_of_current_exception()); }

std::vector<std::byte> receive_result(Ranks& ranks, int from) {
  const std::vector<std::byte> bytes = receive_bytes(ranks, from);
  ByteReader reader(bytes);
  RemoteEnd end;
  reader(end);
  if (end.exit_code == exit_input_error) throw InputError(end.message);
  if (end.exit_code != exit_done) throw std::runtime_error(end.message);
  return receive_bytes(ranks, from);
}

}  // namespace cloudbow
