// SPDX-License-Identifier: BSD-3-Clause
namespace Dynpoint
{
    /// <summary>A body or a tool: it stays in its world until Remove, whether somebody has this object or not.</summary>
    public abstract class Member
    {
        internal Member(World world, uint id)
        {
            World = world;
            Id = id;
        }

        public World World { get; private set; }

        /// <summary>Its number, as in Hit.Body. Once it is removed, it is nobody's.</summary>
        public uint Id { get; private set; }

        /// <summary>The end of a call that began with World.Enter.</summary>
        internal void Finish(Result result, string what)
        {
            World.Leave();
            if (result != Result.Ok) throw DynpointException.Make(result, what, null);
        }
    }
}
