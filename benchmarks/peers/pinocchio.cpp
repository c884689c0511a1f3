/* pinocchio.cpp: the leg as a Pinocchio model, called through its C++ interface with memory made once.
 *
 * The Hessian of a point off the joint is not one of its functions; the shortest way a user has is z_i x J_j from its Jacobian.
 * There is no closed-form inverse.
 */
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/model.hpp>

namespace {
using Eigen::Matrix3d;
using Eigen::Vector3d;
using pinocchio::SE3;
using Jacobian = Eigen::Matrix<double, 6, 3>;

struct Leg {
    pinocchio::Model model;
    pinocchio::FrameIndex foot;

    Leg() {
        Matrix3d quarter;
        quarter << 1, 0, 0, 0, 0, -1, 0, 1, 0;
        const pinocchio::JointModelRZ turn;
        const auto yaw = model.addJoint(0, turn, SE3::Identity(), "yaw");
        const auto thigh = model.addJoint(yaw, turn, SE3(quarter, Vector3d(0, 0, 0.12)), "thigh");
        const auto shank = model.addJoint(thigh, turn, SE3(Matrix3d::Identity(), Vector3d(0.35, 0, 0)), "shank");
        const SE3 end(Matrix3d::Identity(), Vector3d(0.40, 0, 0));
        foot = model.addFrame(pinocchio::Frame("foot", shank, 0, end, pinocchio::OP_FRAME));
    }
};

const Leg leg;
pinocchio::Data data(leg.model);

void core_foot_position(const double *q, double *p) {
    const Eigen::Map<const Vector3d> angles(q);
    pinocchio::forwardKinematics(leg.model, data, angles);
    Eigen::Map<Vector3d> foot(p);
    foot = pinocchio::updateFramePlacement(leg.model, data, leg.foot).translation();
}

Jacobian frame_jacobian(const double *q) {
    const Eigen::Map<const Vector3d> angles(q);
    pinocchio::computeJointJacobians(leg.model, data, angles);
    pinocchio::updateFramePlacement(leg.model, data, leg.foot);
    Jacobian jacobian = Jacobian::Zero();
    pinocchio::getFrameJacobian(leg.model, data, leg.foot, pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
    return jacobian;
}

void core_foot_position_jacobian(const double *q, double *p, double *J) {
    const Jacobian jacobian = frame_jacobian(q);
    Eigen::Map<Vector3d> foot(p);
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> linear(J);
    foot = data.oMf[leg.foot].translation();
    linear = jacobian.topRows<3>();
}

void core_foot_hessian(const double *q, double *H) {
    const Jacobian jacobian = frame_jacobian(q);
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            const Vector3d second = jacobian.col(i).tail<3>().cross(jacobian.col(j).head<3>());
            for (int k = 0; k < 3; ++k) {
                H[9 * k + 3 * i + j] = H[9 * k + 3 * j + i] = second[k];
            }
        }
    }
}
} // namespace

#define WITHOUT_INVERSE
#include "adapter.h"
