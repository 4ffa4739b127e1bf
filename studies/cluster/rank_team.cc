#include "mjdiag/studies/cluster/rank_team.h"

#include <chrono>
#include <thread>

namespace mjdiag {

RankTeam::~RankTeam() {
  if (is_led_here()) End();
}

void RankTeam::Order(int rank, const RankOrder& order) {
  link_->Send(rank, Packed(order));
}

void RankTeam::OrderAll(const RankOrder& order) {
  for (int rank = 1; rank < ranks(); ++rank) Order(rank, order);
}

std::optional<std::pair<int, RankReport>> RankTeam::NextReport() {
  const std::optional<RankMessage> message = link_->Receive();
  if (!message) return std::nullopt;
  return std::pair(message->from, UnpackedReport(message->bytes));
}

void RankTeam::End() {
  if (ended_) return;
  ended_ = true;
  OrderAll({lost_.empty() ? RankOrder::Kind::kEnd : RankOrder::Kind::kEndLost});
  link_->Leave(lost_.empty());
}

std::optional<RankOrder> RankTeam::NextOrder() {
  const std::optional<RankMessage> message = link_->Receive();
  if (!message) return std::nullopt;
  return UnpackedOrder(message->bytes);
}

RankOrder RankTeam::AwaitOrder(double longest) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kBetween = std::chrono::milliseconds(5);
  for (auto heard = Clock::now();;) {
    while (const std::optional<RankOrder> order = NextOrder()) {
      if (order->kind != RankOrder::Kind::kWork) return *order;
      heard = Clock::now();
    }
    if (Clock::now() - heard > std::chrono::duration<double>(longest)) Abort();
    std::this_thread::sleep_for(kBetween);
  }
}

void RankTeam::Leave(const RankOrder& order) {
  link_->Leave(order.kind == RankOrder::Kind::kEnd);
}

}  // namespace mjdiag
