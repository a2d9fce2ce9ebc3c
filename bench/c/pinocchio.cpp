/* Dynamics of a closed mechanism by Pinocchio: the tree of legs and platform, projected on what the
 * loop closures leave.
 *
 *     pinocchio TREE ROUNDS [RESULTS]
 *
 * TREE: doubles, as bench/pinocchio_model.py writes them.  Prints and writes what speed.c does. */

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <Eigen/LU>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

static std::vector<double> given;
static std::size_t at = 0;

static double number() { return given.at(at++); }

static int whole() { return static_cast<int>(number()); }

static Vector3d vector()
{
    const double x = number(), y = number(), z = number();
    return {x, y, z};
}

static Matrix3d matrix()
{
    Matrix3d m;
    for (int row = 0; row < 3; ++row) {
        m.row(row) = vector().transpose();
    }
    return m;
}

static VectorXd entries(int size)
{
    VectorXd a(size);
    for (double &x : a) {
        x = number();
    }
    return a;
}

struct Leg {
    std::size_t end, seat;  /* frames */
    int first, joints, rows;  /* places of its joints in v, rows of its closure */
};

struct State {
    VectorXd q, V, A;
};

static pinocchio::Model model;
static std::vector<Leg> legs;
static std::vector<int> driven;
static std::vector<State> states;
static int task;

static pinocchio::JointIndex add_joint(int number_of_joint)
{
    const int parent = whole(), kind = whole();
    const Vector3d axis = vector();
    const Matrix3d turn = matrix();
    const pinocchio::SE3 placement(turn, vector());
    const std::string name = "joint" + std::to_string(number_of_joint);
    pinocchio::JointModel joint;
    switch (kind) {
    case 0: joint = pinocchio::JointModelFreeFlyer(); break;
    case 1: joint = pinocchio::JointModelPX(); break;
    case 2: joint = pinocchio::JointModelPY(); break;
    case 3: joint = pinocchio::JointModelRZ(); break;
    case 4: joint = pinocchio::JointModelRevoluteUnaligned(axis); break;
    default: joint = pinocchio::JointModelPrismaticUnaligned(axis); break;
    }
    const auto id = model.addJoint(static_cast<std::size_t>(parent), joint, placement, name);
    const double mass = number();
    const Vector3d centre = vector();
    model.appendBodyToJoint(id, pinocchio::Inertia(mass, centre, matrix()));
    return id;
}

static std::size_t add_frame(const std::string &name)
{
    const int joint = whole();
    const pinocchio::SE3 placement(Matrix3d::Identity(), vector());
    return model.addFrame(pinocchio::Frame(name, static_cast<std::size_t>(joint), 0, placement,
                                           pinocchio::OP_FRAME));
}

static void read(const char *path)
{
    std::ifstream file(path, std::ios::binary);
    double x;
    while (file.read(reinterpret_cast<char *>(&x), sizeof x)) {
        given.push_back(x);
    }
    task = whole();
    model.gravity.linear(vector());
    const int joints = whole();
    for (int k = 0; k < joints; ++k) {
        add_joint(k);
    }
    const int count = whole();
    for (int k = 0; k < count; ++k) {
        Leg leg;
        leg.first = whole();
        leg.joints = whole();
        leg.rows = whole();
        leg.end = add_frame("end" + std::to_string(k));
        leg.seat = add_frame("seat" + std::to_string(k));
        legs.push_back(leg);
    }
    driven.resize(static_cast<std::size_t>(whole()));
    for (int &place : driven) {
        place = whole();
    }
    states.resize(static_cast<std::size_t>(whole()));
    for (State &s : states) {
        s = {entries(model.nq), entries(task), entries(task)};
    }
}

/* ---- a state ---- */

struct Work {
    pinocchio::Data data{model};
    MatrixXd G{MatrixXd::Zero(model.nv, task)}, H, all;
    VectorXd v, a;
    Eigen::Matrix<double, 6, Eigen::Dynamic> end{6, model.nv}, seat{6, model.nv};
    std::vector<MatrixXd> inverse;

    Work() : inverse(legs.size()) {}

    bool turns_freely() const { return task == 6; }

    /* Velocities of the tree by V. */
    void eliminate(const State &s)
    {
        const auto axes = pinocchio::LOCAL_WORLD_ALIGNED;
        pinocchio::computeJointJacobians(model, data, s.q);
        pinocchio::updateFramePlacements(model, data);
        G.topRows(task).setIdentity();
        if (turns_freely()) {
            G.topLeftCorner<3, 3>() = data.oMi[1].rotation().transpose();
            G.block<3, 3>(3, 3) = data.oMi[1].rotation().transpose();
        }
        all.resize(task, 0);
        std::vector<VectorXd> across;
        for (std::size_t k = 0; k < legs.size(); ++k) {
            const Leg &leg = legs[k];
            end.setZero();
            seat.setZero();
            pinocchio::getFrameJacobian(model, data, leg.end, axes, end);
            pinocchio::getFrameJacobian(model, data, leg.seat, axes, seat);
            const MatrixXd J = end.block(0, leg.first, leg.rows, leg.joints);
            const MatrixXd P = seat.block(0, 0, leg.rows, task)*G.topRows(task);
            if (leg.rows == leg.joints) {
                inverse[k] = J.partialPivLu().inverse();
            } else {
                inverse[k] = (J.transpose()*J).inverse()*J.transpose();
                const Vector3d a = J.col(0), b = J.col(1);
                across.push_back(P.transpose()*a.cross(b).normalized());
            }
            G.middleRows(leg.first, leg.joints).noalias() = inverse[k]*P;
        }
        H.resize(task, static_cast<int>(driven.size()));
        for (std::size_t k = 0; k < driven.size(); ++k) {
            H.col(static_cast<int>(k)) = G.row(driven[k]).transpose();
        }
        all.resize(task, task);
        all.leftCols(H.cols()) = H;
        for (std::size_t k = 0; k < across.size(); ++k) {
            all.col(H.cols() + static_cast<int>(k)) = across[k];
        }
        v = G*s.V;
    }

    /* Accelerations of the tree. */
    void accelerate(const State &s, const VectorXd &A)
    {
        const auto axes = pinocchio::LOCAL_WORLD_ALIGNED;
        a = VectorXd::Zero(model.nv);
        VectorXd platform = A;
        if (turns_freely()) {
            platform.head<3>() -= s.V.tail<3>().cross(s.V.head<3>());
        }
        a.head(task) = G.topRows(task)*platform;
        pinocchio::forwardKinematics(model, data, s.q, v, a);
        for (std::size_t k = 0; k < legs.size(); ++k) {
            const Leg &leg = legs[k];
            const Vector3d gap =
                pinocchio::getFrameClassicalAcceleration(model, data, leg.end, axes).linear()
                - pinocchio::getFrameClassicalAcceleration(model, data, leg.seat, axes).linear();
            a.segment(leg.first, leg.joints) = -inverse[k]*gap.head(leg.rows);
        }
    }
};

static VectorXd inverse_dynamics(Work &w, const State &s)
{
    w.eliminate(s);
    w.accelerate(s, s.A);
    const VectorXd load = w.G.transpose()*pinocchio::rnea(model, w.data, s.q, w.v, w.a);
    return w.all.partialPivLu().solve(load).head(w.H.cols());
}

struct Dynamics {
    RowMajor M;
    VectorXd Z;
    RowMajor H;
};

static Dynamics dynamics(Work &w, const State &s)
{
    w.eliminate(s);
    w.accelerate(s, VectorXd::Zero(task));
    const VectorXd Z = w.G.transpose()*pinocchio::rnea(model, w.data, s.q, w.v, w.a);
    pinocchio::crba(model, w.data, s.q, pinocchio::Convention::WORLD);
    const MatrixXd inertia = w.data.M.selfadjointView<Eigen::Upper>();
    return {w.G.transpose()*inertia*w.G, Z, w.H};
}

/* ---- results and times ---- */

static void write(std::ofstream &file, const double *a, long size)
{
    file.write(reinterpret_cast<const char *>(a), size*static_cast<long>(sizeof *a));
}

static void write_results(const char *path)
{
    std::ofstream file(path, std::ios::binary);
    Work w;
    std::vector<Dynamics> found;
    for (const State &s : states) {
        const VectorXd tau = inverse_dynamics(w, s);
        write(file, tau.data(), tau.size());
    }
    for (const State &s : states) {
        found.push_back(dynamics(w, s));
    }
    for (const Dynamics &d : found) {
        write(file, d.M.data(), d.M.size());
    }
    for (const Dynamics &d : found) {
        write(file, d.Z.data(), d.Z.size());
    }
    for (const Dynamics &d : found) {
        write(file, d.H.data(), d.H.size());
    }
}

template <typename Function> static double nanoseconds(int rounds, Function function)
{
    Work w;
    double best = std::numeric_limits<double>::infinity(), kept = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (const State &s : states) {
            kept += function(w, s);
        }
        const std::chrono::duration<double, std::nano> time =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count());
    }
    return std::isfinite(kept) ? best/static_cast<double>(states.size()) : kept;
}

int main(int count, char **arguments)
{
    if (count < 3) {
        return 2;
    }
    read(arguments[1]);
    if (count > 3) {
        write_results(arguments[3]);
    }
    const int rounds = std::atoi(arguments[2]);
    std::printf("inverse_dynamics %.2f 0\n", nanoseconds(rounds, [](Work &w, const State &s) {
                    return inverse_dynamics(w, s)[0];
                }));
    std::printf("dynamics %.2f 0\n", nanoseconds(rounds, [](Work &w, const State &s) {
                    return dynamics(w, s).Z[0];
                }));
}
