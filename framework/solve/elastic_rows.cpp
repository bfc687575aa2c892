// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/elastic_rows.h"

#include <algorithm>
#include <cmath>

namespace lapwing {

using Eigen::VectorXd;

void ElasticRows::begin(const std::vector<RowKind>& rows, const VectorXd& away, double penalty,
                        double barrier) {
  constexpr double kLeast = 1e-8;
  active_ = true;
  penalty_ = penalty;
  rows_.clear();
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r] != RowKind::unbounded) rows_.push_back(static_cast<int>(r));
  const Eigen::Index size = away.size();
  for (VectorXd* v : {&p_, &q_, &z_p_, &z_q_}) v->setOnes(size);
  for (VectorXd* v : {&aim_p_, &aim_q_, &steps_.p, &steps_.q, &dz_p_, &dz_q_}) v->setZero(size);
  for (const int r : rows_) {
    const double difference = -away(r);  // q - p
    const double half = (barrier - penalty_ * difference) / (2 * penalty_);
    p_(r) = half + std::sqrt(half * half + barrier * difference / (2 * penalty_));
    if (!(p_(r) > 0) || !std::isfinite(p_(r))) p_(r) = std::max(-difference, 0.0) + kLeast;
    q_(r) = difference + p_(r);
    if (!(q_(r) > 0)) q_(r) = kLeast;
    z_p_(r) = barrier / p_(r);
    z_q_(r) = barrier / q_(r);
  }
}

double ElasticRows::deviation(double barrier) const {
  double worst = 0;
  for (const int r : rows_)
    worst =
        std::max({worst, std::abs(p_(r) * z_p_(r) - barrier), std::abs(q_(r) * z_q_(r) - barrier)});
  return worst;
}

double ElasticRows::aim(int r, double y, double barrier) {
  aim_p_(r) = barrier / z_p_(r) - p_(r) - p_(r) / z_p_(r) * (penalty_ - y - z_p_(r));
  aim_q_(r) = barrier / z_q_(r) - q_(r) - q_(r) / z_q_(r) * (penalty_ + y - z_q_(r));
  return aim_q_(r) - aim_p_(r);
}

void ElasticRows::follow(const VectorXd& y, const VectorXd& dy) {
  for (const int r : rows_) {
    steps_.p(r) = aim_p_(r) + p_(r) / z_p_(r) * dy(r);
    steps_.q(r) = aim_q_(r) - q_(r) / z_q_(r) * dy(r);
    dz_p_(r) = penalty_ - y(r) - z_p_(r) - dy(r);
    dz_q_(r) = penalty_ + y(r) - z_q_(r) + dy(r);
  }
}

void ElasticRows::limit(bool of_multipliers, double share, double& alpha) const {
  const auto shorten = [&](const VectorXd& v, const VectorXd& d) {
    for (const int r : rows_)
      if (d(r) < 0) alpha = std::min(alpha, -share * v(r) / d(r));
  };
  shorten(of_multipliers ? z_p_ : p_, of_multipliers ? dz_p_ : steps_.p);
  shorten(of_multipliers ? z_q_ : q_, of_multipliers ? dz_q_ : steps_.q);
}

void ElasticRows::add_cost(double alpha, double& logarithms, double& sum) const {
  for (const int r : rows_) {
    const double p = p_(r) + (alpha != 0 ? alpha * steps_.p(r) : 0);
    const double q = q_(r) + (alpha != 0 ? alpha * steps_.q(r) : 0);
    logarithms += std::log(p) + std::log(q);
    sum += p + q;
  }
}

void ElasticRows::add_slope(double barrier, double& slope) const {
  for (const int r : rows_)
    slope += penalty_ * (steps_.p(r) + steps_.q(r)) -
             barrier * (steps_.p(r) / p_(r) + steps_.q(r) / q_(r));
}

void ElasticRows::take(double alpha, double of_multipliers) {
  p_ += alpha * steps_.p;
  q_ += alpha * steps_.q;
  z_p_ += of_multipliers * dz_p_;
  z_q_ += of_multipliers * dz_q_;
}

}  // namespace lapwing
