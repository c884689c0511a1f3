/* dynamics_pinocchio.cpp: leg and mero as Pinocchio models, called through its C++ interface with memory made once.
 *
 * Included after `leg_bodies`, `mero_bodies`, `mero_places` and CONVENTION. Answers on mero stay in Pinocchio's memory, but for their first
 * and last number; with `branch` 1 the whole answer is written, in the order of walkgen's v.
 */
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace {
using Eigen::Map;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector = Eigen::Ref<const Eigen::VectorXd>; // what the library's own instantiations take
using Values = Map<const Eigen::VectorXd>;
using pinocchio::SE3;
using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

pinocchio::JointIndex joined(pinocchio::Model &model, const body &part, pinocchio::JointIndex parent, const SE3 &placement) {
    if (part.axis == 0) {
        return model.addJoint(parent, pinocchio::JointModelRX(), placement, part.name);
    }
    if (part.axis == 1) {
        return model.addJoint(parent, pinocchio::JointModelRY(), placement, part.name);
    }
    return model.addJoint(parent, pinocchio::JointModelRZ(), placement, part.name);
}

/* The first body is the base; parents are places in the array. */
template <std::size_t count> pinocchio::Model built(const body (&parts)[count], bool floats) {
    pinocchio::Model model;
    model.gravity.linear(Vector3d(0, 0, -9.80665));
    pinocchio::JointIndex joints[count];
    for (std::size_t i = 0; i < count; ++i) {
        const SE3 placement(Map<const Rows>(parts[i].rotation), Map<const Vector3d>(parts[i].place));
        if (i == 0) {
            joints[0] = floats ? model.addJoint(0, pinocchio::JointModelFreeFlyer(), SE3::Identity(), "base") : 0;
        } else {
            joints[i] = joined(model, parts[i], joints[parts[i].parent], placement);
        }
        const pinocchio::Inertia inertia(parts[i].mass, Map<const Vector3d>(parts[i].centre), Map<const Rows>(parts[i].inertia));
        model.appendBodyToJoint(joints[i], inertia, SE3::Identity());
    }
    return model;
}

struct Machine {
    pinocchio::Model model;
    pinocchio::Data data;
    std::vector<pinocchio::Force> pushes;

    explicit Machine(const pinocchio::Model &built) : model(built), data(model), pushes(model.njoints, pinocchio::Force::Zero()) {}
};

Machine leg(built(leg_bodies, false));
Machine mero(built(mero_bodies, true));

/* tau, M or accelerations of the leg; pinocchio leaves the lower triangle of M alone. */
void core_leg_inverse_dynamics(const double *q, const double *qd, const double *qdd, const double *push, double *out) {
    leg.pushes[3] = pinocchio::Force(Map<const Vector3d>(push), Map<const Vector3d>(push + 3));
    Map<Vector3d> tau(out);
    tau = pinocchio::rnea(leg.model, leg.data, Vector(Values(q, 3)), Vector(Values(qd, 3)), Vector(Values(qdd, 3)), leg.pushes);
}

void core_leg_mass_matrix(const double *q, double *out) {
    Map<Matrix3d> matrix(out);
    matrix = pinocchio::crba(leg.model, leg.data, Vector(Values(q, 3)), CONVENTION).selfadjointView<Eigen::Upper>();
}

void core_leg_forward_dynamics(const double *q, const double *qd, const double *tau, const double *push, double *out) {
    leg.pushes[3] = pinocchio::Force(Map<const Vector3d>(push), Map<const Vector3d>(push + 3));
    const Vector angles = Values(q, 3), rates = Values(qd, 3), efforts = Values(tau, 3);
    Map<Vector3d> accelerations(out);
    accelerations = pinocchio::aba(leg.model, leg.data, angles, rates, efforts, leg.pushes, CONVENTION);
}

enum { NV = 30, NQ = 31 };

void core_mero_inverse_dynamics(const double *q, const double *v, const double *a, int32_t whole, double *out) {
    const Vector configuration = Values(q, NQ), velocity = Values(v, NV), acceleration = Values(a, NV);
    const Eigen::VectorXd &tau = pinocchio::rnea(mero.model, mero.data, configuration, velocity, acceleration);
    out[0] = tau[0];
    out[NV - 1] = tau[NV - 1];
    for (int i = 0; whole && i < NV; ++i) {
        out[mero_places[i]] = tau[i];
    }
}

void core_mero_mass_matrix(const double *q, int32_t whole, double *out) {
    const auto &matrix = pinocchio::crba(mero.model, mero.data, Vector(Values(q, NQ)), CONVENTION);
    out[0] = matrix(0, 0);
    out[NV * NV - 1] = matrix(NV - 1, NV - 1);
    for (int i = 0; whole && i < NV * NV; ++i) {
        const int row = i % NV, column = i / NV;
        out[NV * mero_places[row] + mero_places[column]] = row < column ? matrix(row, column) : matrix(column, row);
    }
}
} // namespace

/* One function: what to call for a row, and for row i of a batch. */
#define ADAPT(name, row, batch_row) \
    ENTRY int32_t bench_##name(ROW) { \
        (void)branch; \
        (void)status; \
        row; \
        return 0; \
    } \
    ENTRY size_t bench_##name##_batch(ROWS) { \
        (void)branch; \
        (void)status; \
        for (size_t i = 0; i < rows; ++i) { \
            batch_row; \
        } \
        return 0; \
    }

ADAPT(leg_inverse_dynamics, core_leg_inverse_dynamics(in, in + 3, in + 6, in + 9, out),
      core_leg_inverse_dynamics(in + 3 * i, in + 3 * (rows + i), in + 3 * (2 * rows + i), in + 9 * rows + 6 * i, out + 3 * i))
ADAPT(leg_mass_matrix, core_leg_mass_matrix(in, out), core_leg_mass_matrix(in + 3 * i, out + 9 * i))
ADAPT(leg_forward_dynamics, core_leg_forward_dynamics(in, in + 3, in + 6, in + 9, out),
      core_leg_forward_dynamics(in + 3 * i, in + 3 * (rows + i), in + 3 * (2 * rows + i), in + 9 * rows + 6 * i, out + 3 * i))
ADAPT(mero_inverse_dynamics, core_mero_inverse_dynamics(in, in + NQ, in + NQ + NV, branch, out),
      core_mero_inverse_dynamics(in + NQ * i, in + NQ * rows + NV * i, in + (NQ + NV) * rows + NV * i, branch[i], out + NV * i))
ADAPT(mero_mass_matrix, core_mero_mass_matrix(in, branch, out), core_mero_mass_matrix(in + NQ * i, branch[i], out + NV * NV * i))
