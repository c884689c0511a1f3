/* newton.cpp: the inverse by Newton's method on Pinocchio's kinematics, with memory made once, as a careful user writes it.
 *
 * Before this file is included, CHAINS(X) is defined: for every leg or arm X(name, joints, posed, kinds, rows), where posed says whether
 * a target is a pose [16] or a position [3], kinds is "RRR" or alike, and rows are the classic a, alpha, d, theta in one list.
 * A position's error is target - foot with the Jacobian in world axes; a pose's is Pinocchio's log6 with its derivative (its own
 * example of inverse kinematics). newton: the whole step. damped: Sugihara 2011, damping half the squared error, which converges from
 * more seeds and as fast near the end.
 */
#include <array>
#include <cstdint>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <string>

namespace {
using pinocchio::SE3;
constexpr int MOST_STEPS = 100;
constexpr double CLOSE = 1e-10;
constexpr double LEAST_DAMPING = 1e-12;

/* Tz(d) Rz(theta) Tx(a) Rx(alpha): what follows a joint's own motion. */
SE3 placement(const double *row) {
    const Eigen::AngleAxisd turn(row[3], Eigen::Vector3d::UnitZ()), twist(row[1], Eigen::Vector3d::UnitX());
    const Eigen::Vector3d along = turn * Eigen::Vector3d(row[0], 0, 0) + Eigen::Vector3d(0, 0, row[2]);
    return SE3((turn * twist).toRotationMatrix(), along);
}

template <int joints, bool posed> struct Chain {
    static constexpr int SIZE = posed ? 6 : 3;
    using Joints = Eigen::Matrix<double, joints, 1>;
    using Error = Eigen::Matrix<double, SIZE, 1>;
    using Jacobian = Eigen::Matrix<double, SIZE, joints>;

    pinocchio::Model model;
    pinocchio::FrameIndex foot;
    pinocchio::Data data;

    Chain(const char *kinds, const std::array<double, 4 * joints> &rows) {
        pinocchio::JointIndex last = 0;
        SE3 before = SE3::Identity();
        for (int i = 0; i < joints; ++i) {
            const std::string name = "joint" + std::to_string(i);
            last = kinds[i] == 'R' ? model.addJoint(last, pinocchio::JointModelRZ(), before, name)
                                   : model.addJoint(last, pinocchio::JointModelPZ(), before, name);
            before = placement(&rows[4 * i]);
        }
        foot = model.addFrame(pinocchio::Frame("foot", last, 0, before, pinocchio::OP_FRAME));
        data = pinocchio::Data(model);
    }

    /* Error and Jacobian at q: J dq = error is Newton's step. */
    void linearised(const Joints &q, const double *target, Error &error, Jacobian &jacobian) {
        pinocchio::computeJointJacobians(model, data, q);
        const SE3 &reached = pinocchio::updateFramePlacement(model, data, foot);
        Eigen::Matrix<double, 6, joints> full = Eigen::Matrix<double, 6, joints>::Zero();
        if constexpr (posed) {
            const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> wanted(target);
            const SE3 missing = reached.actInv(SE3(wanted.template topLeftCorner<3, 3>(), wanted.template topRightCorner<3, 1>()));
            pinocchio::Data::Matrix6 change;
            pinocchio::getFrameJacobian(model, data, foot, pinocchio::LOCAL, full);
            pinocchio::Jlog6(missing.inverse(), change);
            error = pinocchio::log6(missing).toVector();
            jacobian = change * full;
        } else {
            pinocchio::getFrameJacobian(model, data, foot, pinocchio::LOCAL_WORLD_ALIGNED, full);
            error = Eigen::Map<const Error>(target) - reached.translation();
            jacobian = full.template topRows<3>();
        }
    }

    template <bool damped> int32_t solve(const double *target, const double *seed, double *answer) {
        Joints q = Eigen::Map<const Joints>(seed);
        Error error;
        Jacobian jacobian;
        for (int steps = 0; steps <= MOST_STEPS && q.allFinite(); ++steps) {
            linearised(q, target, error, jacobian);
            const double square = error.squaredNorm();
            if (square <= CLOSE * CLOSE) {
                Eigen::Map<Joints>{answer} = q;
                return 0;
            }
            if constexpr (damped) {
                Eigen::Matrix<double, joints, joints> normal = jacobian.transpose() * jacobian;
                normal.diagonal().array() += 0.5 * square + LEAST_DAMPING;
                q += normal.ldlt().solve(jacobian.transpose() * error);
            } else {
                q += jacobian.partialPivLu().solve(error);
            }
        }
        return 1;
    }
};
} // namespace

#define ENTRY(symbol, chain, damped, posed) \
    extern "C" __attribute__((visibility("default"))) int32_t bench_##symbol(const double *in, int32_t, double *out, int32_t *status) { \
        return *status = chain.solve<damped>(in, in + (posed ? 16 : 3), out); \
    }
#define SOLVERS(name, joints, posed, kinds, ...) \
    namespace { \
    Chain<joints, posed> name(kinds, {__VA_ARGS__}); \
    } \
    ENTRY(name##_newton, name, false, posed) \
    ENTRY(name##_damped, name, true, posed)

CHAINS(SOLVERS)
