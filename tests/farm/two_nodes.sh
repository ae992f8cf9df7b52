# Sourced: a Slurm of two nodes on this host, on loopback, below the folder $slurm; needs root, slurmctld and munged.
# Nothing of it is installed or left behind: the daemons are children of this shell, end with it however it ends, and hold
# none of its open files.

# daemon NAME COMMAND...: in the background
daemon() {
    local name=$1
    shift
    (
        for fd in /proc/self/fd/*; do
            fd=${fd##*/}
            ((fd <= 2)) || eval "exec $fd>&-"
        done
        exec setpriv --pdeathsig KILL "$@" </dev/null >"$slurm/$name.out" 2>&1
    ) &
    disown
}

# start_slurm: fails where both nodes are not there after 30 s
start_slurm() {
    local host port=$((20000 + $$ % 10000))
    host=$(hostname -s)
    mkdir -p "$slurm"/{state,n1,n2}
    chmod 755 "$slurm"
    head -c 1024 /dev/urandom >"$slurm/munge.key"
    chmod 600 "$slurm/munge.key"
    # A node is lost after 10 s of silence. 64 tasks are the most that an array may have.
    cat >"$slurm/slurm.conf" <<CONF
ClusterName=rt
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.sock
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/%n
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/%n.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobRequeue=1
RequeueExit=75
ReturnToService=2
SlurmdTimeout=10
MaxArraySize=64
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=2 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=2 State=UNKNOWN
PartitionName=render Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF=$slurm/slurm.conf
    daemon munged munged --foreground --force --key-file="$slurm/munge.key" --socket="$slurm/munge.sock" \
        --pid-file="$slurm/munged.pid" --log-file="$slurm/munged.log" --seed-file="$slurm/munged.seed"
    daemon slurmctld slurmctld -D
    # As its tasks have it: processes_of finds the node's by it.
    SLURMD_NODENAME=n1 daemon n1 slurmd -D -N n1
    SLURMD_NODENAME=n2 daemon n2 slurmd -D -N n2
    local end=$((SECONDS + 30))
    until [[ $(timeout 5 sinfo -h -t idle -o %D 2>/dev/null) == 2 ]]; do
        ((SECONDS < end)) || return 1
        sleep 0.1
    done
}

# processes_of [NODE]: of this Slurm, daemons and tasks
processes_of() {
    local file
    for file in /proc/[0-9]*/environ; do
        grep -qzxF "SLURM_CONF=$slurm/slurm.conf" "$file" 2>/dev/null || continue
        [[ -z ${1:-} ]] || grep -qzxF "SLURMD_NODENAME=$1" "$file" 2>/dev/null || continue
        file=${file%/environ}
        echo "${file#/proc/}"
    done
}

# begin_again: what Slurm would requeue in two minutes
begin_again() {
    local id
    for id in $(timeout 5 squeue -h -r -t PD -o '%i %r' 2>/dev/null | awk '$2 !~ /^(Dependency|Resources|Priority)/ {print $1}'); do
        timeout 5 scontrol update JobId="$id" StartTime=now 2>/dev/null || true
    done
}

# end_processes [NODE]: and those that they began meanwhile
end_processes() {
    local processes
    while processes=$(processes_of "$@") && [[ -n $processes ]]; do
        kill -9 $processes 2>/dev/null || true
        sleep 0.1
    done
}
