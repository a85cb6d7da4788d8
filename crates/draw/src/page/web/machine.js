// A machine at one position of its axes.

const POSE = 12;
const JOINT = 6;

export class Machine {
    constructor(data, functions) {
        this.data = data;
        this.name = data.name;
        this.evaluate = functions[data.poses];
        this.out = new Float64Array(POSE * data.frames.length + JOINT * data.joints.length + data.axes.length);
    }

    /** Brings it to where its axes stand at these motions. */
    move(motions, settings) {
        this.evaluate(...motions, ...settings.values, this.out);
    }

    /** The pose of a frame in the root frame. */
    pose(frame) {
        const m = this.out.subarray(POSE * frame, POSE * (frame + 1));
        return new THREE.Matrix4().set(...m, 0, 0, 0, 1);
    }

    /** The point at which a joint acts and its direction, in the root frame. */
    joint(k) {
        const at = POSE * this.data.frames.length + JOINT * k;
        return {
            point: new THREE.Vector3(...this.out.subarray(at, at + 3)),
            direction: new THREE.Vector3(...this.out.subarray(at + 3, at + 6)),
        };
    }

    axis(k) {
        return this.out[POSE * this.data.frames.length + JOINT * this.data.joints.length + k];
    }
}
