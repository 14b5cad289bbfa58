// SPDX-License-Identifier: BSD-3-Clause
namespace Dynpoint
{
    public partial struct Pose
    {
        /// <summary>Position in m, and a unit quaternion (w, x, y, z).</summary>
        public Pose(Double3 position, Rotation orientation)
        {
            Position = position;
            Orientation = orientation;
        }

        /// <summary>At a place, without a turn.</summary>
        public Pose(double x, double y, double z) : this(new Double3(x, y, z), new Rotation(1, 0, 0, 0))
        {
        }

        /// <summary>At the origin, without a turn.</summary>
        public static Pose Identity
        {
            get { return new Pose(0, 0, 0); }
        }

        public override string ToString()
        {
            return Position + " " + Orientation;
        }
    }

    public partial struct Segment
    {
        /// <summary>A capsule from a to b, m.</summary>
        public Segment(Double3 a, Double3 b, double radius)
        {
            A = a;
            B = b;
            Radius = radius;
        }
    }

    public partial struct Wrench
    {
        public override string ToString()
        {
            return Force + " N " + Torque + " Nm";
        }
    }
}
